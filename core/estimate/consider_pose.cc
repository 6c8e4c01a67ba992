#include "core/estimate/consider_pose.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

/// Pose, then velocity.
constexpr Eigen::Index kMotion = 12;

}  // namespace

ConsiderPose::ConsiderPose(const CalibrationPrior& prior) : slot_(prior.cameras(), -1) {
  const Eigen::Index most = kMotion + prior.size();
  hessian_.setZero(most, most);
  information_.setZero(most, most);
  columns_.setZero(most, 7);
  evidence_.setZero(most);
  inverse_.setZero(most, most);
  prior_.setZero(most, most);
  right_.setZero(most);
  x_.setZero(most);
  kept_.reserve(static_cast<std::size_t>(prior.size()));
}

ConsiderPose::Parts ConsiderPose::parts_of(const ConsideredObservation& observation) const {
  constexpr Eigen::Index kSize = kMotion + kCalibrationNumbers;
  return {{{0, 0, kMotion},
           {kMotion, slot_[observation.camera], kCalibrationNumbers},
           {kSize, first_size_ + static_cast<Eigen::Index>(observation.size), 1},
           {kSize + 1, first_mode_, modes_}}};
}

ConsiderPose::OwnColumns ConsiderPose::own_columns_of(const ConsideredObservation& observation) {
  const ErrorColumns& c = observation.columns;
  OwnColumns columns;
  columns << c.by_pose, c.by_velocity, c.by_camera * CalibrationPrior::units().asDiagonal(),
      c.by_size * CalibrationPrior::kSizeUnit;
  return columns;
}

ConsiderPose::Columns ConsiderPose::columns_of(const ConsideredObservation& observation) const {
  Columns columns(8, kOwn + modes_);
  columns.leftCols<kOwn>() = own_columns_of(observation);
  columns.rightCols(modes_) = observation.by_modes.leftCols(modes_);
  return columns;
}

void ConsiderPose::add(const ConsideredObservation& observation, double sign) {
  const OwnColumns j = own_columns_of(observation);
  const OwnColumns signed_j = sign * j;
  const Vector8d& residual = observation.columns.residual;
  Eigen::Matrix<double, kOwn, kOwn> square;
  square.noalias() = signed_j.transpose() * j;
  const Eigen::Matrix<double, kOwn, 1> pull = signed_j.transpose() * residual;
  const Parts parts = parts_of(observation);
  // Of the system the lower triangle alone.
  for (std::size_t a = 0; a < 3; ++a) {
    right_.segment(parts[a].at, parts[a].count) += pull.segment(parts[a].own, parts[a].count);
    for (std::size_t b = 0; b <= a; ++b) {
      hessian_.block(parts[a].at, parts[b].at, parts[a].count, parts[b].count) +=
          square.block(parts[a].own, parts[b].own, parts[a].count, parts[b].count);
    }
  }
  if (modes_ == 0) return;
  const ModeColumns by_modes = sign * observation.by_modes;
  Eigen::Matrix<double, kMapModes, kOwn> mixed;
  mixed.noalias() = by_modes.transpose() * j;
  for (std::size_t b = 0; b < 3; ++b) {
    hessian_.block(first_mode_, parts[b].at, kMapModes, parts[b].count) +=
        mixed.middleCols(parts[b].own, parts[b].count);
  }
  hessian_.block<kMapModes, kMapModes>(first_mode_, first_mode_) +=
      by_modes.transpose() * observation.by_modes;
  right_.segment<kMapModes>(first_mode_) += by_modes.transpose() * residual;
}

/// The system before any observation: the prior of all that may show.
void ConsiderPose::begin(std::span<const ConsideredObservation> observations,
                         const CalibrationPrior& prior, const Matrix6d& velocity_covariance) {
  std::fill(slot_.begin(), slot_.end(), -1);
  for (const ConsideredObservation& o : observations) slot_[o.camera] = 0;
  kept_.clear();
  for (std::size_t c = 0; c < slot_.size(); ++c) {
    if (slot_[c] < 0) continue;
    slot_[c] = kMotion + static_cast<Eigen::Index>(kept_.size());
    for (Eigen::Index i = 0; i < kCalibrationNumbers; ++i) {
      kept_.push_back(CalibrationPrior::first_of(c) + i);
    }
  }
  modes_ = prior.modes();
  first_size_ = kMotion + static_cast<Eigen::Index>(kept_.size());
  for (Eigen::Index i = prior.at_size(0); i < prior.size(); ++i) kept_.push_back(i);
  size_ = kMotion + static_cast<Eigen::Index>(kept_.size());
  first_mode_ = size_ - modes_;

  const Eigen::Index numbers = size_ - kMotion;
  auto known = prior_.topLeftCorner(numbers, numbers);
  for (Eigen::Index column = 0; column < numbers; ++column) {
    for (Eigen::Index row = 0; row < numbers; ++row) {
      known(row, column) = prior.covariance()(kept_[static_cast<std::size_t>(row)],
                                              kept_[static_cast<std::size_t>(column)]);
    }
  }
  auto h = hessian_.topLeftCorner(size_, size_);
  h.setZero();
  right_.head(size_).setZero();
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(known);
  auto of_calibration = h.bottomRightCorner(numbers, numbers);
  of_calibration.setIdentity();
  factor.matrixL().solveInPlace(of_calibration);
  factor.matrixU().solveInPlace(of_calibration);
  h.block<6, 6>(6, 6) = SymmetricFactor<6>(velocity_covariance).inverse();
}

bool ConsiderPose::solve(std::span<const ConsideredObservation> observations,
                         const CalibrationPrior& prior, const Matrix6d& velocity_covariance) {
  begin(observations, prior, velocity_covariance);
  misfit_ = 0;
  freedoms_ = -6;
  for (const ConsideredObservation& o : observations) {
    if (!o.used) continue;
    add(o);
    misfit_ += o.columns.residual.squaredNorm();
    freedoms_ += 8;
  }
  auto h = hessian_.topLeftCorner(size_, size_);
  information_.topLeftCorner(size_, size_) = h;
  evidence_.head(size_) = right_.head(size_);
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(h);
  if (factor.info() != Eigen::Success) return false;
  auto x = x_.head(size_);
  x = right_.head(size_);
  factor.matrixL().solveInPlace(x);
  misfit_ -= x.squaredNorm();
  factor.matrixU().solveInPlace(x);
  auto inverse = inverse_.topLeftCorner(size_, size_);
  inverse.setIdentity();
  factor.matrixL().solveInPlace(inverse);
  factor.matrixU().solveInPlace(inverse);
  return x.allFinite() && inverse.allFinite();
}

ConsiderPose::Touched ConsiderPose::touched_by(const ConsideredObservation& observation) const {
  const Parts parts = parts_of(observation);
  const Eigen::Index count = parts.back().own + parts.back().count;
  Touched touched;
  touched.value.resize(count);
  touched.covariance.resize(count, count);
  for (const Part& a : parts) {
    touched.value.segment(a.own, a.count) = x_.segment(a.at, a.count);
    for (const Part& b : parts) {
      touched.covariance.block(a.own, b.own, a.count, b.count) =
          inverse_.block(a.at, b.at, a.count, b.count);
    }
  }
  return touched;
}

Eigen::Matrix<double, 6, 8> ConsiderPose::gain(const ConsideredObservation& observation) const {
  return touched_by(observation).covariance.topRows<6>() * columns_of(observation).transpose();
}

std::optional<ConsiderPose::Subset> ConsiderPose::without(
    std::span<const ConsideredObservation* const> left_out) {
  if (left_out.size() == 1) return without_one(*left_out.front());
  auto h = hessian_.topLeftCorner(size_, size_);
  h = information_.topLeftCorner(size_, size_);
  right_.head(size_) = evidence_.head(size_);
  for (const ConsideredObservation* o : left_out) add(*o, -1);
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(h);
  if (factor.info() != Eigen::Success) return std::nullopt;
  // L⁻¹ [e₁ … e₆, b]: products of its columns are the pose's covariance and the pose.
  auto columns = columns_.topRows(size_);
  columns.setZero();
  columns.topLeftCorner<6, 6>().setIdentity();
  columns.col(6) = right_.head(size_);
  factor.matrixL().solveInPlace(columns);
  Subset subset;
  subset.covariance.noalias() = columns.leftCols<6>().transpose() * columns.leftCols<6>();
  subset.step.noalias() = columns.leftCols<6>().transpose() * columns.col(6);
  if (!subset.covariance.allFinite() || !subset.step.allFinite()) return std::nullopt;
  return subset;
}

ConsiderPose::Left ConsiderPose::left_by(const ConsideredObservation& observation) const {
  const Columns j = columns_of(observation);
  const Touched touched = touched_by(observation);
  const Eigen::Matrix<double, 8, Eigen::Dynamic, 0, 8, kMostTouched> half = j * touched.covariance;
  return {observation.columns.residual - j * touched.value, half * j.transpose()};
}

double ConsiderPose::squared_sigmas(const ConsideredObservation& observation) const {
  const Left left = left_by(observation);
  // Leave-one-out of what carries the pose; the plain sum of what does not.
  const double sign = observation.used ? -1 : 1;
  const Matrix8d covariance = Matrix8d::Identity() + sign * left.of_pose;
  return left.residual.dot(SymmetricFactor<8>(covariance).solve(left.residual));
}

std::optional<ConsiderPose::Subset> ConsiderPose::without_one(
    const ConsideredObservation& observation) const {
  const Left left = left_by(observation);
  const Eigen::LLT<Matrix8d> factor(Matrix8d::Identity() - left.of_pose);
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Eigen::Matrix<double, 6, 8> gain = this->gain(observation);
  Subset subset;
  subset.step = step() - gain * factor.solve(left.residual);
  subset.covariance = covariance() + gain * factor.solve(gain.transpose());
  if (!subset.covariance.allFinite() || !subset.step.allFinite()) return std::nullopt;
  return subset;
}

}  // namespace waymark
