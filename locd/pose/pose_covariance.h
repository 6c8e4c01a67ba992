#pragma once

#include <span>
#include <vector>

#include "core/estimate/consider_pose.h"
#include "core/estimate/rig_pose_solver.h"
#include "locd/pose/map_index.h"
#include "locd/pose/motion_filter.h"
#include "locd/pose/set_observation.h"

namespace waymark {

/// The velocity as it is known before a set.
struct VelocityPrior {
  Vector6d velocity = Vector6d::Zero();  ///< m/s, rad/s, world axes
  Matrix6d covariance = Matrix6d::Identity();
};

/// The inliers' normal equations at a pose and velocity, with their present whitening.
[[nodiscard]] MotionEvidence motion_evidence(std::span<const SetObservation> observations,
                                             const MapIndex& map, const RigPoseSolver& solver,
                                             const Rigid3& world_from_rig,
                                             const Vector6d& velocity);

/// The step to the optimum over pose and velocity together, the velocity's prior included.
struct MotionStep {
  Vector6d pose = Vector6d::Zero();
  Vector6d velocity = Vector6d::Zero();
  Matrix6d velocity_covariance = Matrix6d::Zero();  ///< after the set
  Matrix6d pose_per_velocity = Matrix6d::Zero();
};
[[nodiscard]] MotionStep motion_step(const MotionEvidence& evidence, const VelocityPrior& prior);

/// What a pose's covariance lacks where neither the velocity nor the instants of a camera's rows
/// are known: the error of the one times that of the other, which no linearization shows. By
/// `known` and the velocity's covariance after the set. `observations[i]` belongs to
/// `considered[i]`.
[[nodiscard]] Matrix6d covariance_of_unknown_times(
    std::span<const SetObservation> observations, std::span<const ConsideredObservation> considered,
    const ConsiderPose& pose, const CalibrationPrior& known);

/// What a pose's covariance lacks where the map's markers may be wrong alike: of n markers that are
/// wrong in the same way the pose is as wrong, not by √n less. The bound holds for markers
/// correlated in whatever way. Holds its working memory.
class MapDependence {
 public:
  explicit MapDependence(const MapIndex& map);

  /// To be added to the covariance that takes markers for independent. `observations[i]` belongs to
  /// `considered[i]`.
  [[nodiscard]] Matrix6d of(std::span<const SetObservation> observations,
                            std::span<const ConsideredObservation> considered,
                            const ConsiderPose& pose);

 private:
  struct MarkerShare {  ///< of one marker in the pose: its gain, then its covariance there
    std::size_t map_index = 0;
    Matrix6d matrix = Matrix6d::Zero();
  };

  const MapIndex& map_;
  std::vector<MarkerShare> shares_;
};

}  // namespace waymark
