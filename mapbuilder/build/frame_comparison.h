#pragma once

#include <optional>
#include <set>
#include <vector>

#include "core/map/marker_map.h"

namespace waymark {

/// A marker of two maps, the new one laid into the old one's world.
struct ComparedMarker {
  MarkerId id;
  double distance_m = 0;
  double turn_rad = 0;
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< where now − where then, old world
  /// One standard deviation of the offset along itself, by both maps' covariances; nullopt where
  /// one is unknown.
  std::optional<double> sigma_m;
};

/// A map against an earlier one.
struct FrameComparison {
  Rigid3 old_from_new;
  std::vector<ComparedMarker> stayed;             ///< these carry the frame; rising
  std::vector<ComparedMarker> moved;              ///< rising
  std::vector<ComparedMarker> suspects_in_place;  ///< quarantined, but stand where they stood
  std::vector<MarkerId> appeared;
  std::vector<MarkerId> vanished;
};

/// When a marker counts as moved: beyond these and, where known, five of its own sigmas in both
/// maps.
struct MovedLimits {
  double distance_m = 0.01;  ///< (0.001–1) 10 mm: a marker that was pressed on again stays below
  double turn_rad = 0.035;   ///< (0.005–0.5) 2°

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Fewer common markers that agree than this could agree by chance.
inline constexpr std::size_t kFewestThatAgree = 3;

/// Finds the old map's world for a new one by the markers that stayed: common markers propose
/// motions, the one that most markers agree with wins and is refined over them, so that moved
/// markers have no say. `suspects`, quarantined ones, carry nothing, but are compared. nullopt when
/// fewer than `fewest` (≥ 1) common markers agree.
[[nodiscard]] std::optional<FrameComparison> compare_frames(const SubMap& map, const SubMap& old,
                                                            const std::set<MarkerId>& suspects = {},
                                                            const MovedLimits& limits = {},
                                                            std::size_t fewest = kFewestThatAgree);

}  // namespace waymark
