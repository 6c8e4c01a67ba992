#pragma once

#include <map>
#include <set>
#include <vector>

#include "mapbuilder/growth/placement_views.h"

namespace waymark {

/// A marker and where it is to be placed.
struct PlacedMarker {
  MarkerIndex marker;
  Rigid3 world_from_marker;
};

/// What the localized frame sets of a component say of the markers that are not placed yet, apart
/// for each firmness: the number of mapped markers that a rig must see to have a say. Everything
/// given must outlive it.
class PlacementQueue {
 public:
  PlacementQueue(const Selection& selection, const Component& component, FrameSetIndex seed,
                 const MapperOptions& options);

  /// The frame set has a new pose: its markers are estimated anew.
  void take_pose_of(FrameSetIndex frame_set, const Estimate& estimate);

  /// The clear markers of the firmest rigs that have any; without one, the clearest of all. Empty:
  /// no marker is left that can be placed.
  [[nodiscard]] std::vector<PlacedMarker> next(const PreparedObservations& prepared,
                                               const Estimate& estimate);

  void remove(MarkerIndex marker);

 private:
  struct Level {
    int mapped_markers = 0;
    std::set<MarkerIndex> outdated{};  ///< seen by a frame set whose pose is new
    std::map<MarkerIndex, PlacementEstimate> waiting{};
  };

  void estimate_outdated(const PreparedObservations& prepared, const Estimate& estimate,
                         const IndexedVector<FrameSetIndex, int>& mapped, Level& level) const;
  [[nodiscard]] IndexedVector<FrameSetIndex, int> mapped_markers_per_frame_set(
      const Estimate& estimate) const;
  [[nodiscard]] std::vector<PlacedMarker> clear_ones(const Level& level) const;
  [[nodiscard]] std::vector<PlacedMarker> clearest() const;

  const Selection& selection_;
  const Component& component_;
  FrameSetIndex seed_;
  const MapperOptions& options_;
  std::vector<Level> levels_;  ///< by falling firmness
};

}  // namespace waymark
