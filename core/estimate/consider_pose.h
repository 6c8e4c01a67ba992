#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/estimate/calibration_prior.h"
#include "core/estimate/error_columns.h"

namespace waymark {

/// How an observation moves with each of the map's modes.
using ModeColumns = Eigen::Matrix<double, 8, kMapModes>;

/// One observation, whitened by its noise and its marker's own error.
struct ConsideredObservation {
  std::size_t camera = 0;
  std::size_t size = 0;  ///< of its marker, among the prior's
  ErrorColumns columns;
  ModeColumns by_modes = ModeColumns::Zero();  ///< read where the prior has modes
  bool used = false;                           ///< carries the pose
};

/// A pose with consider parameters: the calibration's errors and the velocity's are estimated along
/// with it from one set under their prior, so that its covariance holds them, no observation is
/// called wrong for them, and what the set itself tells of them is used. Least squares in closed
/// form, one linearization. Holds its working memory: solving allocates nothing.
class ConsiderPose {
 public:
  /// For priors of so many cameras, sizes and modes as this one.
  explicit ConsiderPose(const CalibrationPrior& prior);
  /// For so many observations: with fewer it allocates nothing.
  void reserve(std::size_t observations) { left_.reserve(observations); }

  /// At the observations' linearization. `velocity_covariance`: of the velocity that they were
  /// moved by; of no meaning where all corners are of the pose's own instant. False: they don't
  /// determine a pose.
  [[nodiscard]] bool solve(std::span<const ConsideredObservation> observations,
                           const CalibrationPrior& prior, const Matrix6d& velocity_covariance);

  /// From the linearization to the optimum (Rigid3's tangent).
  [[nodiscard]] Vector6d step() const { return x_.head<6>(); }
  [[nodiscard]] Matrix6d covariance() const { return of_motion_.topLeftCorner<6, 6>(); }
  [[nodiscard]] Vector6d velocity_step() const { return x_.segment<6>(6); }
  [[nodiscard]] Matrix6d velocity_covariance() const {
    return of_motion_.bottomRightCorner<6, 6>();
  }
  /// What is left at the optimum, the prior's share included: χ² of `freedoms()` where all is well.
  [[nodiscard]] double misfit() const { return misfit_; }
  [[nodiscard]] int freedoms() const { return freedoms_; }

  // Of the last solve's observations, by their place among them; they must still be there.

  /// How the pose follows an observation's residual, in its whitened units.
  [[nodiscard]] const Eigen::Matrix<double, 6, 8>& gain(std::size_t observation) const {
    return left_[observation].gain;
  }
  /// χ² of 8 freedoms of one observation, held against the pose of all others.
  [[nodiscard]] double squared_sigmas(std::size_t observation) const;
  /// The pose of the last solve without some of the observations that carry it, from the same
  /// linearization. Exact: what they say is taken out of the normal equations.
  struct Subset {
    Vector6d step = Vector6d::Zero();
    Matrix6d covariance = Matrix6d::Zero();
  };
  /// nullopt: what is left determines no pose. Of one observation in closed form, of several by a
  /// factorization.
  [[nodiscard]] std::optional<Subset> without(std::span<const std::size_t> left_out);

 private:
  static constexpr int kMotion = 12;  ///< pose, then velocity
  static constexpr int kOwn = kMotion + kCalibrationNumbers + 1;
  /// By pose and velocity, by its camera's numbers, by its size.
  using OwnColumns = Eigen::Matrix<double, 8, kOwn>;
  /// Some numbers that an observation touches: where they stand among its own, in the system and
  /// in the prior.
  struct Part {
    Eigen::Index own, at, count;
  };
  using Parts = std::array<Part, 3>;
  /// What an observation leaves at the optimum, how far its own say moves the covariance of that
  /// (J C Jᵀ), and how the pose follows it.
  struct Left {
    Vector8d residual;
    Matrix8d of_pose;
    Eigen::Matrix<double, 6, 8> gain;
  };
  [[nodiscard]] Left left_by(const ConsideredObservation& observation);
  [[nodiscard]] std::optional<Subset> without_one(std::size_t observation) const;
  [[nodiscard]] std::optional<Subset> without_several(std::span<const std::size_t> left_out);
  [[nodiscard]] Parts parts_of(const ConsideredObservation& observation) const;
  [[nodiscard]] static OwnColumns own_columns_of(const ConsideredObservation& observation);
  void invert_prior(const CalibrationPrior& prior);
  void begin(std::span<const ConsideredObservation> observations, const CalibrationPrior& prior,
             const Matrix6d& velocity_covariance);
  /// Adds JᵀJ and Jᵀy of one observation where its numbers stand; `sign` −1 takes them out.
  void add(const ConsideredObservation& observation, double sign = 1);

  std::span<const ConsideredObservation> observations_;
  std::vector<Eigen::Index> slot_;  ///< of each camera, −1: sees nothing
  std::vector<Eigen::Index> kept_;  ///< of the prior's numbers those in the system, in its order
  Eigen::Index first_size_ = 0;     ///< where sizes begin in the system
  Eigen::Index first_mode_ = 0;
  Eigen::Index modes_ = 0;
  Eigen::Index size_ = 0;        ///< of the system
  Eigen::MatrixXd hessian_;      ///< and its factor
  Eigen::MatrixXd information_;  ///< of the last solve, before it was factored
  Eigen::MatrixXd columns_;      ///< right-hand sides
  Eigen::MatrixXd half_;         ///< L⁻¹ of the motion's unit vectors: half of its covariance
  Eigen::Matrix<double, kMotion, kMotion> of_motion_;  ///< covariance
  Eigen::VectorXd mean_;   ///< of the prior of the numbers in the system
  Eigen::MatrixXd prior_;  ///< its covariance
  Eigen::MatrixXd factor_;
  Eigen::MatrixXd prior_information_;  ///< its inverse
  Eigen::Index inverted_ = 0;          ///< numbers of it
  Eigen::VectorXd right_;
  Eigen::VectorXd evidence_;  ///< right_ of the last solve
  Eigen::VectorXd x_;
  std::vector<Left> left_;
  double misfit_ = 0;
  int freedoms_ = 0;
};

}  // namespace waymark
