#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/camera/rig.h"
#include "core/estimate/gaussian_bound.h"
#include "locd/pose/pose_estimate.h"
#include "locd/pose/robust_pose.h"

namespace waymark {

/// Computes protection levels by solution separation, as advanced RAIM does (Blanch et al. 2015;
/// for cameras arXiv 1909.08537): of every hypothesis h (nothing is wrong; a marker is; a camera
/// is) the pose x_h that rests on nothing of what is said to be wrong is as good as its covariance
/// says, whatever the fault; so the error of x is within |x − x_h| + k(C_h). The largest of these
/// is the level. There is no threshold, and no prior of faults.
class ProtectionLevels {
 public:
  /// That a level is exceeded, per set and under each hypothesis.
  static constexpr double kRisk = 1e-5;
  /// Sigmas that nobody stated may be so many times too small.
  static constexpr double kGuessed = 1.25;

  /// `point_in_rig`: whose position is protected. `guessed`: the rig's sigmas are defaults.
  ProtectionLevels(std::size_t cameras, const Eigen::Vector3d& point_in_rig, bool guessed);

  /// Of the pose that `robust` has just solved from `observations`. Infinite where a hypothesis
  /// leaves fewer than two markers, or another pose explains the set, too.
  [[nodiscard]] Protection of(std::span<const SetObservation> observations,
                              const PoseSolution& solution, RobustPose& robust);

 private:
  /// Errors of the protected point by those of the rig.
  [[nodiscard]] Matrix6d by_rig(const Rigid3& world_from_rig) const;
  template <typename Wrong>
  void suspect(std::span<const SetObservation> observations, const PoseSolution& solution,
               RobustPose& robust, const Wrong& wrong, Protection& levels);
  void raise(const Vector6d& apart, const Matrix6d& covariance, Protection& levels) const;

  std::size_t cameras_;
  Eigen::Vector3d point_in_rig_;
  double inflation_;
  TailRisk risk_{kRisk};
  std::vector<std::size_t> left_out_;
};

}  // namespace waymark
