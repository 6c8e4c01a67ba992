#include "core/map/quarantine.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/atomic_file.h"
#include "core/map/json_value.h"
#include "core/map/map_file.h"

namespace waymark {
namespace {

constexpr std::size_t kLargestFile = std::size_t{1} << 24;

Expected<MarkerId> marker_of(const nlohmann::json& entry) {
  const auto family = family_from_name(entry.at("family").get<std::string>());
  if (!family) return fail(ErrorKind::bad_data, "no such family");
  const nlohmann::json& id = entry.at("id");
  return parse_marker_id(id.is_string() ? id.get<std::string>() : std::to_string(id.get<int>()),
                         *family);
}

Expected<QuarantinedMarker> entry_of(const nlohmann::json& entry) {
  QuarantinedMarker marker;
  const auto id = marker_of(entry);
  if (!id) return tl::make_unexpected(id.error());
  marker.marker = *id;
  const auto state = entry.at("state").get<std::string>();
  if (state != "MOVED" && state != "UNKNOWN") {
    return fail(ErrorKind::bad_data, "state is neither MOVED nor UNKNOWN");
  }
  marker.state = state == "MOVED" ? QuarantineState::moved : QuarantineState::unknown;
  marker.since_utime = entry.at("since_utime").get<std::int64_t>();
  marker.offset_m = entry.at("offset_m").get<double>();
  if (!std::isfinite(marker.offset_m) || marker.offset_m < 0) {
    return fail(ErrorKind::bad_data, "offset_m is no length");
  }
  return marker;
}

}  // namespace

Expected<Quarantine> read_quarantine(const std::filesystem::path& path) {
  const auto text = read_file(path, kLargestFile);
  if (!text) return tl::make_unexpected(text.error());
  Quarantine quarantine;
  try {
    const auto json = nlohmann::json::parse(*text);
    quarantine.map_hash = json.at("map_hash").get<std::string>();
    for (const nlohmann::json& entry : json.at("markers")) {
      auto marker = entry_of(entry);
      if (!marker) {
        return fail(ErrorKind::bad_data, "{}: entry {}: {}; remove the file to start anew",
                    path.string(), quarantine.markers.size(), marker.error().message);
      }
      quarantine.markers.push_back(*marker);
    }
  } catch (const nlohmann::json::exception& error) {
    return fail(ErrorKind::bad_data, "{}: no quarantine file: {}; remove it to start anew",
                path.string(), error.what());
  }
  return quarantine;
}

Expected<Quarantine> read_quarantine_of(const std::filesystem::path& path, const MarkerMap& map,
                                        const std::filesystem::path& map_path) {
  auto quarantine = read_quarantine(path);
  if (!quarantine) return quarantine;
  const std::string hash = content_hash(map);
  if (quarantine->map_hash == hash) return quarantine;
  return fail(ErrorKind::bad_data,
              "{}: belongs to map {}, but {} is map {}: what has moved against one says nothing of "
              "the other; name the map that the vehicle used",
              path.string(), quarantine->map_hash, map_path.string(), hash);
}

Status write_quarantine(const std::filesystem::path& path, const Quarantine& quarantine) {
  auto sorted = quarantine.markers;
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.marker < b.marker; });
  const bool several =
      !sorted.empty() && sorted.front().marker.family != sorted.back().marker.family;
  nlohmann::ordered_json json;
  json["map_hash"] = quarantine.map_hash;
  json["markers"] = nlohmann::ordered_json::array();
  for (const QuarantinedMarker& marker : sorted) {
    nlohmann::ordered_json entry;
    entry["id"] = json_of(marker.marker, several);
    entry["family"] = name_of(marker.marker.family);
    entry["state"] = marker.state == QuarantineState::moved ? "MOVED" : "UNKNOWN";
    entry["since_utime"] = marker.since_utime;
    entry["offset_m"] = marker.offset_m;
    json["markers"].push_back(entry);
  }
  return write_file_atomically(path, json.dump(1) + "\n");
}

}  // namespace waymark
