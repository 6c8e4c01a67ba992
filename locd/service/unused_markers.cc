#include "locd/service/unused_markers.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace waymark {
namespace {

auto find(const std::vector<QuarantinedMarker>& markers, const MarkerId& marker) {
  return std::find_if(markers.begin(), markers.end(),
                      [&](const QuarantinedMarker& other) { return other.marker == marker; });
}

bool holds(const std::vector<QuarantinedMarker>& markers, const MarkerId& marker) {
  return find(markers, marker) != markers.end();
}

bool is_ignored(const QuarantinedMarker& marker) {
  return marker.state == QuarantineState::ignored;
}

}  // namespace

UnusedMarkers::UnusedMarkers(QuarantineFile& file, std::string map_hash)
    : file_(file), has_map_(!map_hash.empty()), found_with_(std::move(map_hash)) {
  Quarantine known = file_.known();
  auto& markers = known.markers;
  const auto ignored =
      std::stable_partition(markers.begin(), markers.end(), std::not_fn(is_ignored));
  ignored_.assign(ignored, markers.end());
  markers.erase(ignored, markers.end());
  if (!has_map_) found_with_ = known.map_hash;
  if (found_with_ == known.map_hash) found_ = std::move(markers);
}

void UnusedMarkers::use_map(std::string map_hash, std::vector<QuarantinedMarker> found) {
  has_map_ = !map_hash.empty();
  if (!has_map_) return;  // what was found stays for when its map comes back
  found_with_ = std::move(map_hash);
  std::erase_if(found, is_ignored);
  found_ = std::move(found);
}

void UnusedMarkers::set_found(const std::string& map_hash, std::vector<QuarantinedMarker> found,
                              std::int64_t utime) {
  if (map_hash != found_with_) return;
  for (QuarantinedMarker& marker : found) {
    const auto known = find(found_, marker.marker);
    if (known != found_.end()) marker.since_utime = known->since_utime;
    if (marker.since_utime == 0) marker.since_utime = utime;
  }
  found_ = std::move(found);
  write();
}

Status UnusedMarkers::ignore(const MarkerId& marker, std::int64_t utime) {
  if (holds(ignored_, marker)) return {};
  if (ignored_.size() == kMostIgnored) {
    return fail(ErrorKind::usage,
                "{} markers are ignored already; allow one, or list them as "
                "`ignore` in markers.toml and map anew",
                kMostIgnored);
  }
  const auto place = std::upper_bound(
      ignored_.begin(), ignored_.end(), marker,
      [](const MarkerId& id, const QuarantinedMarker& other) { return id < other.marker; });
  ignored_.insert(place, {marker, QuarantineState::ignored, utime, 0});
  write();
  return {};
}

Status UnusedMarkers::allow(const MarkerId& marker) {
  const auto known = find(ignored_, marker);
  if (known == ignored_.end()) {
    return fail(ErrorKind::bad_data, "marker {} is not ignored", format_marker_id(marker, true));
  }
  ignored_.erase(known);
  write();
  return {};
}

bool UnusedMarkers::is_quarantined(const MarkerId& marker) const {
  return has_map_ && holds(found_, marker);
}

std::size_t UnusedMarkers::quarantined() const { return has_map_ ? found_.size() : 0; }

std::vector<MarkerId> UnusedMarkers::ignored() const {
  std::vector<MarkerId> ids;
  for (const QuarantinedMarker& marker : ignored_) ids.push_back(marker.marker);
  return ids;
}

void UnusedMarkers::write() const {
  Quarantine quarantine{found_with_, ignored_};
  for (const QuarantinedMarker& marker : found_) {
    if (!holds(ignored_, marker.marker)) quarantine.markers.push_back(marker);
  }
  file_.write(std::move(quarantine));
}

}  // namespace waymark
