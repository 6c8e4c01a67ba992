#pragma once

#include <functional>
#include <vector>

#include "mapbuilder/bundle/map_state.h"
#include "mapbuilder/growth/marker_placement.h"
#include "mapbuilder/observations/covisibility.h"

namespace waymark {

/// Options of incremental growth.
struct GrowthOptions {
  RigPoseOptions rig_pose;
  PlacementOptions placement;
  /// A marker is placed at once when its runner-up is worse by this (sigmas²); below, only when
  /// nothing clearer is left to do. (0–1000) 20 as in RigPoseOptions.
  double placement_gap = 20.0;
  /// Rigs that see this many mapped markers place new ones first, then those that see fewer: a rig
  /// that hangs on one marker may stand wrong, and everything it places with it. (1–10)
  int firm_markers = 3;
  /// Views that place a marker, half of them the largest, half spread over the rest. (2–1000)
  int max_placement_views = 16;
  /// The joint adjustment runs whenever the map has grown by this factor. (1.05–10)
  double adjust_growth = 1.5;
  /// An unambiguous pose that costs at most this per observation (sigmas²) is not searched again:
  /// twice what Gaussian noise costs in eight residuals. (8–100)
  double explained_sigmas2 = 16.0;
  int threads = 0;  ///< 0 = all processors
};

/// Algorithm 2 for one component: starts at the seed, then in rounds localizes every frame set that
/// sees the map (Algorithm 1), places every marker that localized frame sets see, and adjusts
/// jointly as the map grows. A pose that is still ambiguous is kept with its runner-up until
/// evidence decides. Each round is a pure function of the state before it, so neither order nor
/// threads matter.
class Growth {
 public:
  using AdjustJointly = std::function<void(MapState&)>;
  /// Adjusts these markers (table indices) and the frame sets that see them, all else held.
  using AdjustFresh = std::function<void(const std::vector<int>& markers, MapState&)>;
  using Report = std::function<void(std::size_t placed, std::size_t localized)>;

  Growth(const ObservationTable& table, const Component& component, const GrowthOptions& options);

  /// Grows `state` from `seed` (which becomes the world frame) until nothing is left that can be
  /// placed or localized.
  void grow(int seed, MapState& state, const AdjustFresh& adjust_fresh, const AdjustJointly& adjust,
            const Report& report);

  /// A flip chosen early is reconsidered: every localized frame set and every placed marker of the
  /// component is solved afresh from all its IPPE solutions on its accepted observations; the best
  /// takes the place of what was known (a marker only when it scores better by more than 1 sigma²
  /// over all its views). Returns how many moved.
  std::size_t reconsider(MapState& state) const;

  /// Localizes (again) every frame set of the component against the markers that are placed. Those
  /// that see none, or can't be localized, have no pose afterwards.
  void localize_all(MapState& state) const;

  /// Localizes (again) the frame sets that a joint adjustment leaves out, because fewer than two of
  /// their observations are accepted, and those that have no pose yet.
  void localize_unadjusted(MapState& state) const;

 private:
  using FrameSetFilter = std::function<bool(int frame_set)>;

  [[nodiscard]] std::vector<FixedMarkerObservation> mapped_observations(const MapState& state,
                                                                        int frame_set) const;
  void localize(const std::vector<int>& frame_sets, MapState& state) const;
  /// Algorithm 1 from all candidates, unless the known pose, refined, explains everything already.
  [[nodiscard]] std::optional<RigPoseEstimate> solve_afresh(
      RigPoseSolver& solver, std::span<const FixedMarkerObservation> observations,
      const std::optional<RigPoseEstimate>& known) const;
  [[nodiscard]] bool differ(const Rigid3& a, const Rigid3& b) const;
  /// At most `most` accepted views of the marker by localized frame sets that the filter takes; of
  /// all its views where none is accepted.
  [[nodiscard]] std::vector<PlacementView> placement_views(const MapState& state, int marker,
                                                           std::size_t most,
                                                           const FrameSetFilter& firm) const;
  [[nodiscard]] std::size_t max_placement_views() const {
    return static_cast<std::size_t>(options_.max_placement_views);
  }
  [[nodiscard]] std::vector<std::optional<PlacementEstimate>> place(
      const std::vector<int>& markers, const MapState& state, const FrameSetFilter& firm) const;
  [[nodiscard]] std::vector<int> mapped_markers_per_frame_set(const MapState& state) const;

  const ObservationTable& table_;
  const Component& component_;
  GrowthOptions options_;
};

}  // namespace waymark
