#include <algorithm>
#include <iterator>
#include <numbers>

#include "core/map/json_value.h"
#include "mapbuilder/evaluate/evaluation.h"

namespace waymark {
namespace {

using nlohmann::ordered_json;

constexpr int kSchema = 1;
/// How many of the worst or the missing the text names.
constexpr std::size_t kNamed = 10;

double degrees(double angle_rad) { return angle_rad * 180 / std::numbers::pi; }

/// The figures of an alignment; null where there was nothing to align.
void add_accuracy(ordered_json& json, const std::optional<PoseAccuracy>& errors,
                  const char* aligned_on, const char* aligned_on_a_line) {
  if (!errors) {
    for (const auto* key : {"translation_rmse_m", "rotation_rmse_deg", "scale",
                            "sim3_translation_rmse_m", "aligned_on"}) {
      json[key] = nullptr;
    }
    return;
  }
  json["translation_rmse_m"] = nine_decimals(errors->rmse.translation_m);
  json["rotation_rmse_deg"] = nine_decimals(degrees(errors->rmse.rotation_rad));
  json["scale"] = nine_decimals(errors->scale);
  json["sim3_translation_rmse_m"] = nine_decimals(errors->sim3_translation_rmse_m);
  json["aligned_on"] = errors->positions_on_a_line ? aligned_on_a_line : aligned_on;
}

ordered_json markers_json(const MarkerEvaluation& markers, bool with_family) {
  ordered_json missing = ordered_json::array();
  for (const MarkerId& id : markers.missing) missing.push_back(json_of(id, with_family));
  ordered_json json{{"truth", markers.truth}, {"found", markers.found.size()}};
  json["missing"] = std::move(missing);
  add_accuracy(json, markers.errors, "centres", "corners");
  ordered_json each = ordered_json::array();
  for (std::size_t i = 0; markers.errors && i < markers.found.size(); ++i) {
    const PoseError& error = markers.errors->each[i];
    each.push_back({{"id", json_of(markers.found[i], with_family)},
                    {"translation_m", nine_decimals(error.translation_m)},
                    {"rotation_deg", nine_decimals(degrees(error.rotation_rad))}});
  }
  json["each"] = std::move(each);
  return json;
}

ordered_json cameras_json(const CameraEvaluation& cameras) {
  ordered_json json{{"truth", cameras.truth}, {"found", cameras.found}};
  add_accuracy(json, cameras.errors, "positions", "poses");
  return json;
}

ordered_json cameras_in_map_json(const CameraEvaluation& cameras) {
  if (!cameras.rmse_in_map) return nullptr;
  return {{"truth", cameras.truth},
          {"found", cameras.found},
          {"translation_rmse_m", nine_decimals(cameras.rmse_in_map->translation_m)},
          {"rotation_rmse_deg", nine_decimals(degrees(cameras.rmse_in_map->rotation_rad))}};
}

std::string text_of_accuracy(const std::optional<PoseAccuracy>& errors) {
  if (!errors) return "nothing to compare";
  return fmt::format("{:.2f} mm, {:.4f}° RMSE after SE(3); scale {:.6f}, Sim(3) {:.2f} mm",
                     1e3 * errors->rmse.translation_m, degrees(errors->rmse.rotation_rad),
                     errors->scale, 1e3 * errors->sim3_translation_rmse_m);
}

std::string text_of_missing(const MarkerEvaluation& markers, bool with_family) {
  if (markers.missing.empty()) return {};
  std::string text = "  missing:";
  for (std::size_t i = 0; i < std::min(kNamed, markers.missing.size()); ++i) {
    text += " " + format_marker_id(markers.missing[i], with_family);
  }
  if (markers.missing.size() > kNamed) {
    text += fmt::format(" and {} more", markers.missing.size() - kNamed);
  }
  return text + "\n";
}

std::string text_of_worst(const MarkerEvaluation& markers, bool with_family) {
  if (!markers.errors) return {};
  const std::vector<PoseError>& each = markers.errors->each;
  std::vector<std::size_t> order(each.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return each[a].translation_m > each[b].translation_m;
  });
  order.resize(std::min(kNamed, order.size()));
  std::string text = "  worst markers:\n";
  for (const std::size_t i : order) {
    fmt::format_to(std::back_inserter(text), "    {:>14} {:9.2f} mm {:8.4f}°\n",
                   format_marker_id(markers.found[i], with_family), 1e3 * each[i].translation_m,
                   degrees(each[i].rotation_rad));
  }
  return text;
}

std::string text_of(const MarkerEvaluation& markers, bool with_family) {
  std::string text = fmt::format("  markers: {} of {}; {}\n", markers.found.size(), markers.truth,
                                 text_of_accuracy(markers.errors));
  if (markers.errors && markers.errors->positions_on_a_line) {
    text += "  the markers' positions lie on a line: their corners are aligned\n";
  }
  return text + text_of_missing(markers, with_family) + text_of_worst(markers, with_family);
}

std::string text_of(const CameraEvaluation& cameras) {
  std::string text = fmt::format("  cameras: {} of {}; {}\n", cameras.found, cameras.truth,
                                 text_of_accuracy(cameras.errors));
  if (cameras.errors && cameras.errors->positions_on_a_line) {
    text += "  the cameras' positions lie on a line: their poses are aligned\n";
  }
  if (cameras.rmse_in_map) {
    text += fmt::format("  cameras, carried by the markers' alignment: {:.2f} mm, {:.4f}°\n",
                        1e3 * cameras.rmse_in_map->translation_m,
                        degrees(cameras.rmse_in_map->rotation_rad));
  }
  return text;
}

}  // namespace

std::string format_evaluation_json(const std::vector<SubMapEvaluation>& submaps, bool with_family) {
  ordered_json list = ordered_json::array();
  for (const SubMapEvaluation& submap : submaps) {
    ordered_json json;
    json["markers"] = submap.markers ? markers_json(*submap.markers, with_family) : ordered_json();
    json["cameras"] = submap.cameras ? cameras_json(*submap.cameras) : ordered_json();
    json["cameras_in_map"] = submap.cameras ? cameras_in_map_json(*submap.cameras) : ordered_json();
    list.push_back(std::move(json));
  }
  ordered_json document{{"schema", kSchema}};
  document["submaps"] = std::move(list);
  return document.dump(2) + "\n";
}

std::string format_evaluation_text(const std::vector<SubMapEvaluation>& submaps, bool with_family) {
  std::string text;
  for (std::size_t i = 0; i < submaps.size(); ++i) {
    text += fmt::format("sub-map {}\n", i);
    if (submaps[i].markers) text += text_of(*submaps[i].markers, with_family);
    if (submaps[i].cameras) text += text_of(*submaps[i].cameras);
  }
  return text;
}

}  // namespace waymark
