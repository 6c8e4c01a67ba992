#pragma once

#include <vector>

#include "core/geometry/rigid3.h"

namespace waymark::simulator {

/// A point that cam0 passes, and where it looks there.
struct Waypoint {
  Eigen::Vector3d at_m;
  double look_deg =
      0;  ///< left of the direction of travel, or of the world's x axis (see TrajectoryPlan)
  double pitch_deg = 0;  ///< above the horizon
};

/// What a scene file says about the way through it.
struct TrajectoryPlan {
  std::vector<Waypoint> waypoints;  ///< at least 3; the last leads back to the first
  bool look_from_travel =
      true;           ///< look_deg counts from the direction of travel, else from world x
  int positions = 0;  ///< evenly spaced along the way
  double speed_mps = 0.5;
};

/// Smooth closed way of cam0 through its way-points: a periodic Catmull–Rom spline in position and
/// in looking direction, followed at constant speed.
class Trajectory {
 public:
  /// The plan has at least 3 way-points, of which neighbours differ (checked by the scene's
  /// reader).
  explicit Trajectory(const TrajectoryPlan& plan);

  [[nodiscard]] double length_m() const { return arc_m_.back(); }

  /// Position of cam0's centre after `arc_m` metres; any real number, the way is closed.
  [[nodiscard]] Eigen::Vector3d position_m(double arc_m) const;

  /// world_from_cam0 after `arc_m` metres: z forward along the looking direction, x level to the
  /// right.
  [[nodiscard]] Rigid3 world_from_cam0(double arc_m) const;

 private:
  /// Spline parameter (way-point units) at an arc length.
  [[nodiscard]] double parameter_at(double arc_m) const;

  std::vector<Waypoint> waypoints_;
  bool look_from_travel_;
  std::vector<double> arc_m_;  ///< at parameters k / kSamplesPerSegment
};

}  // namespace waymark::simulator
