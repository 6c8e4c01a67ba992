#include "core/map/quarantine.h"

#include <algorithm>
#include <limits>
#include <set>

#include "core/base/atomic_file.h"
#include "core/base/json_fields.h"
#include "core/map/json_value.h"
#include "core/map/map_file.h"

namespace waymark {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
/// Beyond any marker's way within a building.
constexpr double kMaxOffset_m = 1e6;

std::string_view name_of(QuarantineState state) {
  switch (state) {
    case QuarantineState::moved:
      return "MOVED";
    case QuarantineState::unknown:
      return "UNKNOWN";
    case QuarantineState::ignored:
      return "IGNORED";
  }
  return "";
}

QuarantinedMarker read_marker(JsonFields& fields) {
  QuarantinedMarker marker;
  marker.marker = read_marker_id(fields);
  marker.state =
      static_cast<QuarantineState>(fields.choice("state", {"MOVED", "UNKNOWN", "IGNORED"}));
  marker.since_utime = fields.integer("since_utime", 0, std::numeric_limits<std::int64_t>::max());
  marker.offset_m = fields.number("offset_m", 0, kMaxOffset_m);
  return marker;
}

Quarantine read_document(JsonFields& fields) {
  Quarantine quarantine;
  quarantine.map_hash = fields.text("map_hash");
  std::set<MarkerId> seen;
  fields.each("markers", [&](JsonFields& entry) {
    const QuarantinedMarker marker = read_marker(entry);
    if (entry.good() && !seen.insert(marker.marker).second) {
      entry.reject(
          fmt::format("marker {} stands there twice", format_marker_id(marker.marker, true)));
    }
    quarantine.markers.push_back(marker);
  });
  return quarantine;
}

}  // namespace

Expected<Quarantine> parse_quarantine(std::string_view text, const std::string& name) {
  const auto document = parse_json(text, name, kMaxBytes);
  if (!document) return tl::make_unexpected(document.error());
  JsonFields fields(*document, name);
  auto quarantine = read_document(fields);
  if (const auto status = fields.finish(); !status) {
    return fail(ErrorKind::bad_data, "{}; remove the file to start anew", status.error().message);
  }
  return quarantine;
}

Expected<Quarantine> read_quarantine(const std::filesystem::path& path) {
  const auto text = read_file(path, kMaxBytes);
  if (!text) return tl::make_unexpected(text.error());
  return parse_quarantine(*text, path.string());
}

Expected<std::optional<Quarantine>> read_quarantine_if_any(const std::filesystem::path& path) {
  std::error_code why;
  if (std::filesystem::symlink_status(path, why).type() == std::filesystem::file_type::not_found) {
    return std::optional<Quarantine>();
  }
  auto read = read_quarantine(path);
  if (!read) return tl::make_unexpected(read.error());
  return std::optional(*std::move(read));
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
    entry["state"] = name_of(marker.state);
    entry["since_utime"] = marker.since_utime;
    entry["offset_m"] = marker.offset_m;
    json["markers"].push_back(entry);
  }
  return write_file_atomically(path, json.dump(1) + "\n");
}

}  // namespace waymark
