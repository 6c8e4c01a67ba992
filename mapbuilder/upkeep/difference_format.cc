#include "mapbuilder/upkeep/difference_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/geometry/degrees.h"
#include "core/map/json_value.h"
#include "core/map/map_json.h"
#include "core/marker/marker_id_list.h"

namespace waymark {
namespace {

using nlohmann::ordered_json;

constexpr int kSchema = 1;
/// How many moved markers the text lists of one sub-map.
constexpr std::size_t kListed = 50;
/// A scale that differs by this many of its sigmas, and by 10 ppm, is another one.
constexpr double kScaleSigmas = 5.0;
constexpr double kSameScale = 1e-5;

double stayed_rms_m(const SubMapDifference& pair) {
  double sum = 0;
  for (const ComparedMarker& marker : pair.comparison.stayed) {
    sum += marker.distance_m * marker.distance_m;
  }
  return std::sqrt(sum / static_cast<double>(pair.comparison.stayed.size()));
}

bool is_another_scale(const SubMapDifference& pair) {
  if (!pair.old_from_new_scale) return false;
  const double off = std::abs(*pair.old_from_new_scale - 1);
  return off > kSameScale && off > kScaleSigmas * pair.scale_sigma;
}

std::vector<MarkerId> ids_of(const std::vector<ComparedMarker>& markers) {
  std::vector<MarkerId> ids;
  for (const ComparedMarker& marker : markers) ids.push_back(marker.id);
  return ids;
}

std::size_t moved_count(const MapDifference& difference) {
  std::size_t count = 0;
  for (const auto& pair : difference.submaps) count += pair.comparison.moved.size();
  return count;
}

std::string submap_name(const MapDifference& difference, const SubMapDifference& pair) {
  const bool one = difference.old_submaps == 1 && difference.new_submaps == 1;
  return one ? "" : fmt::format("sub-map {}: ", pair.new_submap);
}

void add_world(const MapDifference& difference, const SubMapDifference& pair,
               std::vector<std::string>& notices) {
  const std::string name = submap_name(difference, pair);
  if (pair.world_shift_m > MovedLimits{}.distance_m) {
    notices.push_back(fmt::format(
        "{}another world: poses shift by up to {:.1f} mm and turn by {:.3f}°; waypoints stored in "
        "the old map must be moved, or the new one built with --frame-of the old",
        name, 1e3 * pair.world_shift_m, kDegreesPerRadian * pair.world_turn_rad));
  } else {
    notices.push_back(fmt::format("{}the world is the old one, to {:.2f} mm at its markers", name,
                                  1e3 * pair.world_shift_m));
  }
  if (is_another_scale(pair)) {
    notices.push_back(fmt::format("{}lengths differ by {:+.0f} ± {:.0f} ppm of the old map's", name,
                                  1e6 * (1 / *pair.old_from_new_scale - 1),
                                  1e6 * pair.scale_sigma));
  }
  if (pair.new_z_is_up != pair.old_z_is_up) {
    notices.push_back(name + (pair.new_z_is_up ? "z is up now: poses get a yaw"
                                               : "z is no longer known to be up: poses lose yaw"));
  }
  if (!pair.by_majority()) {
    notices.push_back(
        fmt::format("{}only {} of {} common markers agree: if more moved than stayed, it is the "
                    "other way round",
                    name, pair.comparison.stayed.size(), pair.common));
  }
}

void add_listed(const char* words, const std::vector<MarkerId>& ids, bool with_family,
                std::vector<std::string>& notices) {
  if (ids.empty()) return;
  notices.push_back(fmt::format(fmt::runtime(words), format_marker_ids(ids, with_family)));
}

std::string text_of_moved(const ComparedMarker& marker, bool with_family) {
  std::string text =
      fmt::format("  moved {}: {:.1f} mm ({:+.1f}, {:+.1f}, {:+.1f})",
                  format_marker_id(marker.id, with_family), 1e3 * marker.distance_m,
                  1e3 * marker.offset_m.x(), 1e3 * marker.offset_m.y(), 1e3 * marker.offset_m.z());
  text += marker.sigma_m && *marker.sigma_m > 0
              ? fmt::format(", {:.1f} sigmas of {:.2f} mm", marker.distance_m / *marker.sigma_m,
                            1e3 * *marker.sigma_m)
              : ", sigma unknown";
  return text + fmt::format("; turned {:.2f}°\n", kDegreesPerRadian * marker.turn_rad);
}

std::string text_of_sigmas(const SubMapDifference& pair) {
  const auto text = [](const std::optional<double>& sigma_m) {
    return sigma_m ? fmt::format("{:.2f} mm", 1e3 * *sigma_m) : std::string("unknown");
  };
  return text(pair.old_median_sigma_m) + " → " + text(pair.new_median_sigma_m);
}

std::string text_of_submap(const SubMapDifference& pair, bool with_family) {
  const FrameComparison& comparison = pair.comparison;
  const auto up = [](bool z_is_up) { return z_is_up ? ", z is up" : ""; };
  std::string text = fmt::format(
      "\nold sub-map {}, new sub-map {}\n"
      "  aligned on   {} of {} common markers{}: {}\n"
      "  these differ {:.2f} mm RMS\n"
      "  frame        {}{} → {}{}\n"
      "  world        {:.2f} mm at its markers, {:.3f}°\n",
      pair.old_submap, pair.new_submap, comparison.stayed.size(), pair.common,
      pair.by_majority() ? "" : " (no majority)",
      format_marker_ids(ids_of(comparison.stayed), with_family), 1e3 * stayed_rms_m(pair),
      name_of(pair.old_frame), up(pair.old_z_is_up), name_of(pair.new_frame), up(pair.new_z_is_up),
      1e3 * pair.world_shift_m, kDegreesPerRadian * pair.world_turn_rad);
  if (pair.old_from_new_scale) {
    text += fmt::format("  lengths      {:+.1f} ± {:.1f} ppm{}\n",
                        1e6 * (1 / *pair.old_from_new_scale - 1), 1e6 * pair.scale_sigma,
                        pair.compared_at_scale != 1 ? ", compared at the old map's" : "");
  }
  text += fmt::format("  median sigma {}\n", text_of_sigmas(pair));
  for (std::size_t i = 0; i < std::min(kListed, comparison.moved.size()); ++i) {
    text += text_of_moved(comparison.moved[i], with_family);
  }
  if (comparison.moved.size() > kListed) {
    text += fmt::format("  and {} more; --json has all\n", comparison.moved.size() - kListed);
  }
  return text;
}

std::string text_of_lists(const MapDifference& difference) {
  std::string text;
  const bool with_family = difference.several_families;
  const auto add = [&](const char* name, const std::vector<MarkerId>& ids) {
    if (ids.empty()) return;
    text += fmt::format("{:<14} {}\n", name, format_marker_ids(ids, with_family));
  };
  add("new", difference.appeared);
  add("gone", difference.vanished);
  for (const RenamedMarker& one : difference.renamed) {
    text += fmt::format("renamed        {} → {}\n", format_marker_id(one.from, with_family),
                        format_marker_id(one.to, with_family));
  }
  std::map<std::string, std::vector<MarkerId>> by_sizes;  // a print size changes for many at once
  for (const ResizedMarker& one : difference.resized) {
    by_sizes[fmt::format("{:.4f} → {:.4f} m", one.old_size_m, one.new_size_m)].push_back(one.id);
  }
  for (const auto& [sizes, ids] : by_sizes) {
    text += fmt::format("size           {}: {}\n", sizes, format_marker_ids(ids, with_family));
  }
  add("verified now", difference.verified);
  add("not verified", difference.unverified);
  add("not compared", difference.not_compared);
  return text.empty() ? text : "\n" + text;
}

ordered_json or_null(const std::optional<double>& value) {
  return value ? ordered_json(nine_decimals(*value)) : ordered_json(nullptr);
}

ordered_json json_of_vector(const Eigen::Vector3d& v) {
  return {nine_decimals(v.x()), nine_decimals(v.y()), nine_decimals(v.z())};
}

ordered_json json_of_ids(const std::vector<MarkerId>& ids, bool with_family) {
  ordered_json list = ordered_json::array();
  for (const MarkerId& id : ids) list.push_back(json_of(id, with_family));
  return list;
}

ordered_json json_of_submap(const SubMapDifference& pair, bool with_family) {
  const FrameComparison& comparison = pair.comparison;
  const Eigen::Quaterniond& q = comparison.old_from_new.rotation;
  ordered_json json{{"old", pair.old_submap}, {"new", pair.new_submap}, {"common", pair.common}};
  json["stayed"] = json_of_ids(ids_of(comparison.stayed), with_family);
  json["by_majority"] = pair.by_majority();
  json["old_from_new"] = {
      {"translation_m", json_of_vector(comparison.old_from_new.translation)},
      {"quaternion_xyzw",
       {nine_decimals(q.x()), nine_decimals(q.y()), nine_decimals(q.z()), nine_decimals(q.w())}}};
  json["world_shift_m"] = nine_decimals(pair.world_shift_m);
  json["world_turn_deg"] = nine_decimals(kDegreesPerRadian * pair.world_turn_rad);
  json["scale"] = nullptr;
  if (pair.old_from_new_scale) {
    json["scale"] = {{"old_from_new", nine_decimals(*pair.old_from_new_scale)},
                     {"sigma", nine_decimals(pair.scale_sigma)}};
  }
  json["compared_at_scale"] = nine_decimals(pair.compared_at_scale);
  json["frame"] = {{"old", name_of(pair.old_frame)}, {"new", name_of(pair.new_frame)}};
  json["z_is_up"] = {{"old", pair.old_z_is_up}, {"new", pair.new_z_is_up}};
  json["median_sigma_m"] = {{"old", or_null(pair.old_median_sigma_m)},
                            {"new", or_null(pair.new_median_sigma_m)}};
  json["stayed_rms_m"] = nine_decimals(stayed_rms_m(pair));
  json["moved"] = ordered_json::array();
  for (const ComparedMarker& marker : comparison.moved) {
    json["moved"].push_back({{"id", json_of(marker.id, with_family)},
                             {"distance_m", nine_decimals(marker.distance_m)},
                             {"offset_m", json_of_vector(marker.offset_m)},
                             {"sigma_m", or_null(marker.sigma_m)},
                             {"turn_deg", nine_decimals(kDegreesPerRadian * marker.turn_rad)}});
  }
  return json;
}

}  // namespace

std::vector<std::string> what_a_vehicle_notices(const MapDifference& difference) {
  if (difference.same()) return {};
  const bool with_family = difference.several_families;
  std::vector<std::string> notices;
  std::vector<MarkerId> moved;
  for (const SubMapDifference& pair : difference.submaps) {
    add_world(difference, pair, notices);
    const auto more = ids_of(pair.comparison.moved);
    moved.insert(moved.end(), more.begin(), more.end());
  }
  std::sort(moved.begin(), moved.end());
  add_listed(
      "with the old map it finds these moved and leaves them out, with the new one it uses "
      "them: {}",
      moved, with_family, notices);
  add_listed("new to it, no longer UNKNOWN: {}", difference.appeared, with_family, notices);
  add_listed("no longer used; where they were all it saw it has no pose: {}", difference.vanished,
             with_family, notices);
  std::vector<MarkerId> renamed;
  for (const RenamedMarker& one : difference.renamed) renamed.push_back(one.to);
  add_listed("used under a new name: {}", renamed, with_family, notices);
  std::vector<MarkerId> resized;
  for (const ResizedMarker& one : difference.resized) resized.push_back(one.id);
  add_listed("of another size, so nearer or farther in the old map than they are: {}", resized,
             with_family, notices);
  if (difference.new_submaps != difference.old_submaps) {
    notices.push_back(
        fmt::format("parts that nothing ties: {} instead of {}; each has a world of "
                    "its own",
                    difference.new_submaps, difference.old_submaps));
  }
  notices.emplace_back("its quarantine ends, for it belongs to the old map");
  return notices;
}

std::string format_difference_text(const MapDifference& difference) {
  if (difference.same()) return fmt::format("the same map: {}\n", difference.old_hash);
  const bool with_family = difference.several_families;
  std::string text = fmt::format(
      "old {}: {} markers in {} sub-maps\n"
      "new {}: {} markers in {} sub-maps\n"
      "{} moved, {} new, {} gone, {} renamed, {} of another size\n",
      difference.old_hash, difference.old_markers, difference.old_submaps, difference.new_hash,
      difference.new_markers, difference.new_submaps, moved_count(difference),
      difference.appeared.size(), difference.vanished.size(), difference.renamed.size(),
      difference.resized.size());
  for (const SubMapDifference& pair : difference.submaps) text += text_of_submap(pair, with_family);
  text += text_of_lists(difference) + "\na vehicle will notice\n";
  for (const std::string& notice : what_a_vehicle_notices(difference)) {
    text += "  - " + notice + "\n";
  }
  return text;
}

std::string format_difference_json(const MapDifference& difference) {
  const bool with_family = difference.several_families;
  const auto side = [](const std::string& hash, std::size_t markers, std::size_t submaps) {
    return ordered_json{{"content_hash", hash}, {"markers", markers}, {"submaps", submaps}};
  };
  ordered_json json{{"schema", kSchema}, {"same", difference.same()}};
  json["old"] = side(difference.old_hash, difference.old_markers, difference.old_submaps);
  json["new"] = side(difference.new_hash, difference.new_markers, difference.new_submaps);
  json["submaps"] = ordered_json::array();
  for (const SubMapDifference& pair : difference.submaps) {
    json["submaps"].push_back(json_of_submap(pair, with_family));
  }
  json["appeared"] = json_of_ids(difference.appeared, with_family);
  json["vanished"] = json_of_ids(difference.vanished, with_family);
  json["renamed"] = ordered_json::array();
  for (const RenamedMarker& one : difference.renamed) {
    json["renamed"].push_back(
        {{"from", json_of(one.from, with_family)}, {"to", json_of(one.to, with_family)}});
  }
  json["resized"] = ordered_json::array();
  for (const ResizedMarker& one : difference.resized) {
    json["resized"].push_back({{"id", json_of(one.id, with_family)},
                               {"old_m", nine_decimals(one.old_size_m)},
                               {"new_m", nine_decimals(one.new_size_m)}});
  }
  json["verified"] = json_of_ids(difference.verified, with_family);
  json["unverified"] = json_of_ids(difference.unverified, with_family);
  json["not_compared"] = json_of_ids(difference.not_compared, with_family);
  json["vehicle"] = what_a_vehicle_notices(difference);
  return json.dump(2) + "\n";
}

}  // namespace waymark
