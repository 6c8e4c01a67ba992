#include "mapbuilder/commands/info_command.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/one_line.h"
#include "core/map/json_value.h"
#include "core/map/map_file.h"
#include "core/map/map_json.h"
#include "core/map/map_records.h"
#include "core/map/marker_distance.h"
#include "core/map/marker_search.h"

namespace waymark {
namespace {

using nlohmann::ordered_json;

constexpr int kSchema = 1;
/// How many unverified markers the text names.
constexpr std::size_t kNamed = 20;

/// Figures over the markers of a sub-map.
struct Summary {
  std::set<Family> families;
  std::set<double> sizes_m;
  std::vector<MarkerId> not_verified;
  std::uint64_t observations = 0;
  std::uint64_t rejected = 0;
  Eigen::Vector3d extent_m;              ///< of the centres, along the world's axes
  std::optional<double> median_sigma_m;  ///< root of the position covariance's trace; of known ones
  std::optional<double> largest_sigma_m;  ///< likewise
  std::size_t unknown_covariances = 0;
};

Summary summarize(const SubMap& submap) {
  Summary summary;
  Eigen::Vector3d lowest = submap.markers.front().world_from_marker.translation;
  Eigen::Vector3d highest = lowest;
  std::vector<double> sigmas_m;
  for (const MapMarker& marker : submap.markers) {
    summary.families.insert(marker.id.family);
    summary.sizes_m.insert(marker.size_m);
    if (!marker.verified) summary.not_verified.push_back(marker.id);
    summary.observations += marker.observations;
    summary.rejected += marker.rejected;
    lowest = lowest.cwiseMin(marker.world_from_marker.translation);
    highest = highest.cwiseMax(marker.world_from_marker.translation);
    if (marker.covariance_known()) {
      sigmas_m.push_back(std::sqrt(std::max(0.0, marker.covariance.topLeftCorner<3, 3>().trace())));
    }
  }
  summary.extent_m = highest - lowest;
  summary.unknown_covariances = submap.markers.size() - sigmas_m.size();
  if (sigmas_m.empty()) return summary;
  std::sort(sigmas_m.begin(), sigmas_m.end());
  summary.median_sigma_m = sigmas_m[sigmas_m.size() / 2];
  summary.largest_sigma_m = sigmas_m.back();
  return summary;
}

std::vector<std::string> family_names(const Summary& summary) {
  std::vector<std::string> names;
  for (const Family family : summary.families) names.emplace_back(name_of(family));
  return names;
}

ordered_json submap_json(const SubMap& submap, bool with_family) {
  const Summary summary = summarize(submap);
  ordered_json not_verified = ordered_json::array();
  for (const MarkerId& id : summary.not_verified) {
    not_verified.push_back(json_of(id, with_family));
  }
  ordered_json json{{"frame", name_of(submap.frame)},
                    {"z_is_up", submap.z_is_up},
                    {"markers", submap.markers.size()}};
  json["not_verified"] = std::move(not_verified);
  json["families"] = family_names(summary);
  json["sizes_m"] = summary.sizes_m;
  json["extent_m"] = {nine_decimals(summary.extent_m.x()), nine_decimals(summary.extent_m.y()),
                      nine_decimals(summary.extent_m.z())};
  json["frame_sets"] = submap.frame_sets;
  json["observations"] = summary.observations;
  json["rejected"] = summary.rejected;
  json["rms_px"] = submap.rms_px;
  json["rms_all_px"] = submap.rms_all_px;
  const auto or_null = [](const std::optional<double>& value) {
    return value ? ordered_json(nine_decimals(*value)) : ordered_json(nullptr);
  };
  json["median_sigma_m"] = or_null(summary.median_sigma_m);
  json["largest_sigma_m"] = or_null(summary.largest_sigma_m);
  json["unknown_covariances"] = summary.unknown_covariances;
  return json;
}

std::string format_json(const MarkerMap& map) {
  ordered_json json{{"schema", kSchema},
                    {"container_version", record_version(map)},
                    {"content_hash", content_hash(map)},
                    {"builder_version", map.builder_version},
                    {"rig_fingerprint", map.rig_fingerprint}};
  json["capture_fingerprints"] = map.capture_fingerprints;
  ordered_json submaps = ordered_json::array();
  for (const SubMap& submap : map.submaps) {
    submaps.push_back(submap_json(submap, map.several_families()));
  }
  json["submaps"] = std::move(submaps);
  constexpr bool kAsciiOnly = true;  // a map's texts may hold what a terminal obeys
  return json.dump(2, ' ', kAsciiOnly, ordered_json::error_handler_t::replace) + "\n";
}

std::string text_of_unverified(const Summary& summary, bool with_family) {
  if (summary.not_verified.empty()) return {};
  std::string text = "  one view, not verified:";
  for (std::size_t i = 0; i < std::min(kNamed, summary.not_verified.size()); ++i) {
    text += " " + format_marker_id(summary.not_verified[i], with_family);
  }
  if (summary.not_verified.size() > kNamed) {
    text += fmt::format(" and {} more", summary.not_verified.size() - kNamed);
  }
  return text + "\n";
}

std::string text_of_sigmas(const Summary& summary) {
  const auto unknown = summary.unknown_covariances;
  if (!summary.median_sigma_m) return "unknown: nothing may rely on this map";
  return fmt::format("{:.2f} mm median, {:.2f} mm at most{}", 1e3 * *summary.median_sigma_m,
                     1e3 * *summary.largest_sigma_m,
                     unknown > 0 ? fmt::format("; unknown of {} markers", unknown) : "");
}

std::string text_of_submap(const SubMap& submap, std::size_t number, bool with_family) {
  const Summary summary = summarize(submap);
  return fmt::format(
             "\nsub-map {}\n"
             "  frame          {}{}\n"
             "  markers        {} of {}, sizes {} m\n"
             "  extent         {:.3f} × {:.3f} × {:.3f} m\n"
             "  sigma          {}\n"
             "  observations   {} accepted, {} rejected, in {} frame sets\n"
             "  RMS            {:.4f} px accepted, {:.4f} px all\n",
             number, name_of(submap.frame), submap.z_is_up ? ", z is up" : "",
             submap.markers.size(), fmt::join(family_names(summary), ", "),
             fmt::join(summary.sizes_m, ", "), summary.extent_m.x(), summary.extent_m.y(),
             summary.extent_m.z(), text_of_sigmas(summary), summary.observations, summary.rejected,
             submap.frame_sets, submap.rms_px, submap.rms_all_px) +
         text_of_unverified(summary, with_family);
}

std::string format_text(const MarkerMap& map) {
  const auto or_none = [](const std::string& text) { return text.empty() ? "none" : text; };
  std::string text = fmt::format(
      "content hash     {}\n"
      "built by         {}\n"
      "rig              {}\n"
      "captures         {}\n"
      "sub-maps         {}\n",
      content_hash(map), or_none(in_one_line(map.builder_version)), or_none(map.rig_fingerprint),
      or_none(fmt::format("{}", fmt::join(map.capture_fingerprints, " "))), map.submaps.size());
  for (std::size_t i = 0; i < map.submaps.size(); ++i) {
    text += text_of_submap(map.submaps[i], i, map.several_families());
  }
  return text;
}

/// Two markers of one sub-map.
struct MarkerPair {
  std::size_t submap = 0;
  const MapMarker* from = nullptr;
  const MapMarker* to = nullptr;
};

Expected<MarkerPair> find_pair(const MarkerMap& map, const std::string& name,
                               const std::pair<std::string, std::string>& asked) {
  std::vector<MarkerId> ids;
  for (const std::string& text : {asked.first, asked.second}) {
    const auto id = parse_marker_id(text, map.families().only());
    if (!id) return fail(id.error().kind, "--distance: {}", id.error().message);
    ids.push_back(*id);
  }
  if (ids[0] == ids[1]) {
    return fail(ErrorKind::usage, "--distance {} {}: one marker; name two", asked.first,
                asked.second);
  }
  const auto found = find_markers(map, name, ids);
  if (!found) return tl::make_unexpected(found.error());
  const FoundMarker& from = (*found)[0];
  const FoundMarker& to = (*found)[1];
  if (from.submap != to.submap) {
    const bool with_family = map.several_families();
    return fail(ErrorKind::bad_data,
                "{}: marker {} is in sub-map {}, marker {} in sub-map {}: nothing ties the two, "
                "their distance is not known",
                name, format_marker_id(ids[0], with_family), from.submap,
                format_marker_id(ids[1], with_family), to.submap);
  }
  return MarkerPair{from.submap, from.marker, to.marker};
}

std::string text_of_distance(const MarkerDistance& distance, bool considered) {
  std::string text = fmt::format("distance     {:.6f} m, centre to centre\n", distance.distance_m);
  if (distance.sigma_m) {
    text += fmt::format(
        "within map   sigma {:.3f} mm, the two taken as independent; {:.3f} mm at most\n",
        1e3 * *distance.sigma_m, 1e3 * *distance.sigma_bound_m);
  } else {
    text += "within map   sigma unknown: the map holds none of them, or they stand at one point\n";
  }
  if (distance.sigma_metric_m) {
    return text + fmt::format("metric       sigma {:.3f} mm{}\n", 1e3 * *distance.sigma_metric_m,
                              considered ? ", calibration and sizes considered"
                                         : " at most, by measured lengths");
  }
  return text +
         (distance.sigma_m
              ? "metric       sigma unknown: the scale rests on stated marker sizes, and the map "
                "does not hold how sure they are; build with --survey and a measured distance\n"
              : "metric       sigma unknown\n");
}

std::string format_distance(const MarkerMap& map, const MarkerPair& pair, bool as_json) {
  const MarkerDistance distance =
      distance_between(*pair.from, *pair.to, map.submaps[pair.submap].frame);
  const bool considered = pair.from->considered() && pair.to->considered();
  if (!as_json) return text_of_distance(distance, considered);
  const bool with_family = map.several_families();
  const auto or_null = [](const std::optional<double>& value) {
    return value ? ordered_json(nine_decimals(*value)) : ordered_json(nullptr);
  };
  const ordered_json json{{"schema", kSchema},
                          {"from", json_of(pair.from->id, with_family)},
                          {"to", json_of(pair.to->id, with_family)},
                          {"submap", pair.submap},
                          {"distance_m", nine_decimals(distance.distance_m)},
                          {"sigma_m", or_null(distance.sigma_m)},
                          {"sigma_bound_m", or_null(distance.sigma_bound_m)},
                          {"sigma_metric_m", or_null(distance.sigma_metric_m)}};
  return json.dump(2) + "\n";
}

}  // namespace

Status run_info(const InfoOptions& options, std::ostream& out) {
  const auto map = read_map_file(options.map);
  if (!map) return tl::make_unexpected(map.error());
  if (!options.distance) {
    out << (options.json ? format_json(*map) : format_text(*map));
    return {};
  }
  const auto pair = find_pair(*map, options.map.string(), *options.distance);
  if (!pair) return tl::make_unexpected(pair.error());
  out << format_distance(*map, *pair, options.json);
  return {};
}

}  // namespace waymark
