#pragma once

#include <optional>
#include <set>
#include <vector>

#include "mapbuilder/build/built_submap.h"

namespace waymark {

/// Gives a built sub-map another world: poses, covariances and trajectory move.
void move_world(BuiltSubMap& submap, const Rigid3& new_from_old);

/// Mean of the cameras' upward image directions (−y) in the world over the trajectory; its length
/// is 1 when they never turned over and 0 when they looked everywhere, or there is no trajectory.
[[nodiscard]] Eigen::Vector3d camera_up_in_world(const BuiltSubMap& submap,
                                                 const Observations& observations,
                                                 const Calibration& calibration);

/// What tells where up is.
enum class LevelBy {
  floor,  ///< markers that lie on the floor, face up: their normals are up
  walls,  ///< markers that hang on walls: their normals are level
};

/// The rotation new_from_old about the origin that makes z point up; nullopt where the markers and
/// the cameras don't tell (up_direction.h).
[[nodiscard]] std::optional<Rigid3> level_world(const BuiltSubMap& submap, LevelBy by,
                                                const Eigen::Vector3d& camera_up_in_world);

/// A marker of both maps that stands elsewhere.
struct MovedMarker {
  MarkerId id;
  double distance_m = 0;
  double turn_rad = 0;
};

/// A map against an earlier one.
struct FrameComparison {
  Rigid3 old_from_new;
  std::vector<MovedMarker> moved;
  std::vector<MovedMarker> suspects_in_place;  ///< quarantined, but stand where they stood
  std::vector<MarkerId> appeared;
  std::vector<MarkerId> vanished;
  std::size_t unmoved = 0;  ///< common markers that carry the frame
};

/// When a marker counts as moved: beyond these and, where known, five of its own sigmas in both
/// maps.
struct MovedLimits {
  double distance_m = 0.01;  ///< (0.001–1) 10 mm: a marker that was pressed on again stays below
  double turn_rad = 0.035;   ///< (0.005–0.5) 2°

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Finds the old map's world for a new one by the markers that stayed: every common marker proposes
/// a motion, the one that most markers agree with wins and is refined over them, so that moved
/// markers have no say. `suspects`, quarantined ones, carry nothing, but are compared. nullopt when
/// fewer than 3 common markers agree.
[[nodiscard]] std::optional<FrameComparison> compare_frames(const SubMap& map, const SubMap& old,
                                                            const std::set<MarkerId>& suspects = {},
                                                            const MovedLimits& limits = {});

}  // namespace waymark
