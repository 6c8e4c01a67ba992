#include "mapbuilder/growth/placement_queue.h"

namespace waymark {

PlacementQueue::PlacementQueue(const Selection& selection, const Component& component,
                               FrameSetIndex seed, const MapperOptions& options)
    : selection_(selection), component_(component), seed_(seed), options_(options) {
  for (int mapped = options.growth.firm_markers; mapped >= 1; --mapped) levels_.push_back({mapped});
}

void PlacementQueue::take_pose_of(FrameSetIndex frame_set, const Estimate& estimate) {
  for (const ObservationIndex index : selection_.used_in(frame_set)) {
    const MarkerIndex marker = selection_[index].marker;
    if (estimate.world_from_marker[marker]) continue;
    for (Level& level : levels_) level.outdated.insert(marker);
  }
}

void PlacementQueue::remove(MarkerIndex marker) {
  for (Level& level : levels_) {
    level.waiting.erase(marker);
    level.outdated.erase(marker);
  }
}

std::vector<PlacedMarker> PlacementQueue::next(const PreparedObservations& prepared,
                                               const Estimate& estimate) {
  IndexedVector<FrameSetIndex, int> mapped = mapped_markers_per_frame_set(estimate);
  mapped[seed_] = options_.growth.firm_markers;
  for (Level& level : levels_) {
    estimate_outdated(prepared, estimate, mapped, level);
    std::vector<PlacedMarker> clear = clear_ones(level);
    if (!clear.empty()) return clear;
  }
  return clearest();
}

void PlacementQueue::estimate_outdated(const PreparedObservations& prepared,
                                       const Estimate& estimate,
                                       const IndexedVector<FrameSetIndex, int>& mapped,
                                       Level& level) const {
  const std::vector<MarkerIndex> markers(level.outdated.begin(), level.outdated.end());
  level.outdated.clear();
  const auto firm = [&](FrameSetIndex frame_set) {
    return mapped[frame_set] >= level.mapped_markers;
  };
  const auto placed = place_markers(prepared, estimate, markers, firm, options_);
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (placed[i]) level.waiting[markers[i]] = *placed[i];
  }
}

IndexedVector<FrameSetIndex, int> PlacementQueue::mapped_markers_per_frame_set(
    const Estimate& estimate) const {
  IndexedVector<FrameSetIndex, int> count(estimate.world_from_rig.size(), 0);
  for (const FrameSetIndex frame_set : component_.frame_sets) {
    for (const ObservationIndex index : selection_.used_in(frame_set)) {
      if (estimate.world_from_marker[selection_[index].marker]) ++count[frame_set];
    }
  }
  return count;
}

std::vector<PlacedMarker> PlacementQueue::clear_ones(const Level& level) const {
  std::vector<PlacedMarker> clear;
  for (const auto& [marker, placement] : level.waiting) {
    if (placement.gap >= options_.growth.placement_gap) {
      clear.push_back({marker, placement.best.pose});
    }
  }
  return clear;
}

std::vector<PlacedMarker> PlacementQueue::clearest() const {
  const std::map<MarkerIndex, PlacementEstimate>& waiting = levels_.back().waiting;
  auto best = waiting.begin();
  for (auto one = waiting.begin(); one != waiting.end(); ++one) {
    if (one->second.gap > best->second.gap) best = one;
  }
  if (best == waiting.end()) return {};
  return {{best->first, best->second.best.pose}};
}

}  // namespace waymark
