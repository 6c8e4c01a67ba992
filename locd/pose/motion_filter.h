#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/base/range.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/stamp.h"

namespace waymark {

/// How the vehicle is taken to move.
struct MotionOptions {
  double max_age_s = 0.5;         ///< older poses predict nothing
  double speed_sigma_mps = 1.0;   ///< before anything is known, standing ± this (0.05–20)
  double turn_sigma_radps = 0.7;  ///< likewise (0.05–20)
  /// White acceleration, root of its spectral density: how far the velocity wanders in 1 s.
  /// (0.01–100) A forklift that brakes at 2 m/s² for half a second, or begins to turn at 40°/s in
  /// as long, lies within 2 sigma.
  double accel_density = 0.7;       ///< m/s² per √Hz
  double turn_accel_density = 0.5;  ///< rad/s² per √Hz

  static constexpr Range kMaxAge_s{0.05, 10};
  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Where the rig is expected, and how sure that is.
struct MotionPrediction {
  Rigid3 world_from_rig;
  Matrix6d covariance = Matrix6d::Zero();
  Vector6d velocity = Vector6d::Zero();  ///< m/s, rad/s, world axes
  Matrix6d velocity_covariance = Matrix6d::Zero();
  bool velocity_known = false;  ///< from two poses at least
};

/// What one set says of pose and velocity together: its cost's quadratic approximation at
/// (world_from_rig, velocity). Only corners of other instants than the set's tell of the velocity.
struct MotionEvidence {
  Rigid3 world_from_rig;
  Vector6d velocity = Vector6d::Zero();
  Matrix6d of_pose = Matrix6d::Zero();           ///< Σ JᵀWJ
  Matrix6d of_both = Matrix6d::Zero();           ///< Σ t JᵀWJ
  Matrix6d of_velocity = Matrix6d::Zero();       ///< Σ t² JᵀWJ
  Vector6d towards_pose = Vector6d::Zero();      ///< −Σ JᵀWr
  Vector6d towards_velocity = Vector6d::Zero();  ///< −Σ t JᵀWr
};

/// Constant-velocity Kalman filter over accepted poses: seeds the solver, tells the velocity for
/// exposures that are not simultaneous, and holds single markers against it. It never enters the
/// published pose: those stay independent of one another.
class MotionFilter {
 public:
  /// The options are valid (checked).
  explicit MotionFilter(const MotionOptions& options);

  /// nullopt without a pose, or when the last is older than max_age_s or newer than `stamp`.
  [[nodiscard]] std::optional<MotionPrediction> predict(Stamp stamp) const;

  /// Takes what a set says, linearized at the prediction's velocity (zero without one). A stamp
  /// that does not rise, or a gap, starts anew.
  void update(Stamp stamp, const MotionEvidence& evidence);

  void reset() { updates_ = 0; }

  /// What is believed of the velocity before anything is known.
  [[nodiscard]] Matrix6d unknown_velocity_covariance() const;

 private:
  using Matrix12d = Eigen::Matrix<double, 12, 12>;
  struct State {
    Rigid3 pose;
    Vector6d velocity;
    Matrix12d covariance;
  };
  [[nodiscard]] State propagate(double seconds) const;

  MotionOptions options_;
  int updates_ = 0;
  Stamp stamp_{0};
  State state_;
};

}  // namespace waymark
