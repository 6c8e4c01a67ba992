#include "locd/record/marker_tally.h"

#include <algorithm>
#include <cmath>

#include "core/marker/marker_id_list.h"

namespace waymark {

MarkerTally::MarkerTally(std::size_t most) : most_(most) { seen_.reserve(most); }

void MarkerTally::clear() {
  seen_.clear();
  more_ = false;
}

void MarkerTally::count(const PoseEstimate& estimate) {
  for (const ObservedMarker& seen : estimate.observations) {
    if (seen.verdict != ObservationVerdict::ignored) count(seen);
  }
}

void MarkerTally::count(const ObservedMarker& seen) {
  constexpr double kShareOfSide = 0.5;
  const Eigen::Vector2d center_px =
      (seen.corners_px[0] + seen.corners_px[1] + seen.corners_px[2] + seen.corners_px[3]) / 4;
  auto known = std::lower_bound(seen_.begin(), seen_.end(), seen.marker,
                                [](const Seen& s, const MarkerId& id) { return s.marker < id; });
  if (known == seen_.end() || known->marker != seen.marker) {
    if (seen_.size() == most_) {
      more_ = true;
      return;
    }
    seen_.insert(known, {seen.marker, 1, seen.camera, center_px});
    return;
  }
  const double side_px = std::sqrt(area_px2(seen.corners_px));
  if (known->camera == seen.camera &&
      (center_px - known->center_px).norm() < kShareOfSide * side_px) {
    return;
  }
  ++known->views;
  known->camera = seen.camera;
  known->center_px = center_px;
}

std::vector<MarkerId> MarkerTally::seen_once() const {
  std::vector<MarkerId> once;
  for (const Seen& seen : seen_) {
    if (seen.views == 1) once.push_back(seen.marker);
  }
  return once;
}

std::string MarkerTally::verdict() const {
  if (seen_.empty()) {
    return "no marker was seen: is markers.toml of the right family, is it bright and sharp "
           "enough?";
  }
  const bool with_family = seen_.front().marker.family != seen_.back().marker.family;
  const std::vector<MarkerId> once = seen_once();
  std::string text = fmt::format("{}{} marker{}", more_ ? "more than " : "", seen_.size(),
                                 seen_.size() == 1 ? "" : "s");
  if (once.empty()) return text + ", each from several places";
  return fmt::format("{}, {} seen once: pass {} again", text, once.size(),
                     format_marker_ids(once, with_family));
}

}  // namespace waymark
