#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/camera/rig.h"
#include "core/estimate/calibration_sigmas.h"
#include "core/estimate/error_columns.h"

namespace waymark {

/// What is known of a rig's calibration errors and of the markers' sizes before a set: zero, with a
/// covariance. Everything is kept in units of usual sigmas, so that numbers of all kinds are alike.
class CalibrationPrior {
 public:
  /// All cameras alike; the place of the one whose frame is the rig's is what it is by definition.
  /// `size_share`: sigma of the prints' size.
  CalibrationPrior(const Rig& rig, const CalibrationSigmas& sigmas, double size_share);

  [[nodiscard]] std::size_t cameras() const { return cameras_; }
  /// Numbers in all: 13 per camera, and 1.
  [[nodiscard]] Eigen::Index size() const { return covariance_.rows(); }
  [[nodiscard]] static Eigen::Index first_of(std::size_t camera) {
    return static_cast<Eigen::Index>(camera) * kCalibrationNumbers;
  }
  /// In units of usual sigmas, squared.
  [[nodiscard]] const Eigen::MatrixXd& covariance() const { return covariance_; }
  /// The camera's variances in their own units.
  [[nodiscard]] CalibrationVector variances_of(std::size_t camera) const;
  [[nodiscard]] double size_variance() const;

  /// Numbers that may be wrong by so much more, independently of all else: `sigmas` in their units.
  void widen(std::size_t camera, const CalibrationVector& sigmas);

  /// The usual sigmas: what one unit is.
  [[nodiscard]] static const CalibrationVector& units();
  static constexpr double kSizeUnit = 1e-3;

 private:
  std::size_t cameras_;
  Eigen::MatrixXd covariance_;
};

/// One observation, whitened by its noise and its marker's own error.
struct ConsideredObservation {
  std::size_t camera = 0;
  ErrorColumns columns;
  bool used = false;  ///< carries the pose
};

/// A pose with consider parameters: the calibration's errors and the velocity's are estimated along
/// with it from one set under their prior, so that its covariance holds them, no observation is
/// called wrong for them, and what the set itself tells of them is used. Least squares in closed
/// form, one linearization. Holds its working memory; allocates nothing once it has seen all
/// cameras.
class ConsiderPose {
 public:
  explicit ConsiderPose(std::size_t cameras);

  /// At the observations' linearization. `velocity_covariance`: of the velocity that they were
  /// moved by; of no meaning where all corners are of the pose's own instant. False: they don't
  /// determine a pose.
  [[nodiscard]] bool solve(std::span<const ConsideredObservation> observations,
                           const CalibrationPrior& prior, const Matrix6d& velocity_covariance);

  /// From the linearization to the optimum (Rigid3's tangent).
  [[nodiscard]] Vector6d step() const { return x_.head<6>(); }
  [[nodiscard]] Matrix6d covariance() const { return inverse_.topLeftCorner<6, 6>(); }
  [[nodiscard]] Vector6d velocity_step() const { return x_.segment<6>(6); }
  [[nodiscard]] Matrix6d velocity_covariance() const { return inverse_.block<6, 6>(6, 6); }
  /// What is left at the optimum, the prior's share included: χ² of `freedoms()` where all is well.
  [[nodiscard]] double misfit() const { return misfit_; }
  [[nodiscard]] int freedoms() const { return freedoms_; }
  /// How the pose follows an observation's residual, in its whitened units.
  [[nodiscard]] Eigen::Matrix<double, 6, 8> gain(const ConsideredObservation& observation) const;
  /// χ² of 8 freedoms of one observation, held against the pose of all others.
  [[nodiscard]] double squared_sigmas(const ConsideredObservation& observation) const;

 private:
  using Columns = Eigen::Matrix<double, 8, 12 + kCalibrationNumbers + 1>;
  using Own = Eigen::Matrix<double, 12 + kCalibrationNumbers + 1, 12 + kCalibrationNumbers + 1>;
  /// The numbers that an observation of this camera touches, side by side, and their covariance.
  struct Touched {
    Eigen::Matrix<double, Own::ColsAtCompileTime, 1> value;
    Own covariance;
  };
  [[nodiscard]] Touched touched_by(std::size_t camera) const;
  [[nodiscard]] Columns columns_of(const ConsideredObservation& observation) const;
  /// Adds JᵀJ and Jᵀy of one observation where its numbers stand.
  void add(const ConsideredObservation& observation);
  [[nodiscard]] Eigen::Index slot_of(std::size_t camera) const { return slot_[camera]; }

  std::vector<Eigen::Index> slot_;  ///< of each camera, −1: sees nothing
  Eigen::Index size_ = 0;           ///< of the system
  Eigen::MatrixXd hessian_;
  Eigen::MatrixXd inverse_;
  Eigen::MatrixXd prior_;
  Eigen::VectorXd right_;
  Eigen::VectorXd x_;
  double misfit_ = 0;
  int freedoms_ = 0;
};

}  // namespace waymark
