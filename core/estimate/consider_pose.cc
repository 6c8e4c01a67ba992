#include "core/estimate/consider_pose.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "core/geometry/dense_products.h"
#include "core/geometry/symmetric_factor.h"

namespace waymark {

ConsiderPose::ConsiderPose(const CalibrationPrior& prior) : slot_(prior.cameras(), -1) {
  const Eigen::Index most = kMotion + prior.size();
  hessian_.setZero(most, most);
  information_.setZero(most, most);
  columns_.setZero(most, 8);
  half_.setZero(most, kMotion);
  evidence_.setZero(most);
  mean_.setZero(prior.size());
  prior_.setZero(prior.size(), prior.size());
  factor_.setZero(prior.size(), prior.size());
  prior_information_.setZero(prior.size(), prior.size());
  right_.setZero(most);
  x_.setZero(most);
  kept_.reserve(static_cast<std::size_t>(prior.size()));
}

ConsiderPose::Parts ConsiderPose::parts_of(const ConsideredObservation& observation) const {
  constexpr Eigen::Index kSize = kMotion + kCalibrationNumbers;
  return {{{0, 0, kMotion},
           {kMotion, slot_[observation.camera], kCalibrationNumbers},
           {kSize, first_size_ + static_cast<Eigen::Index>(observation.size), 1}}};
}

ConsiderPose::OwnColumns ConsiderPose::own_columns_of(const ConsideredObservation& observation) {
  const ErrorColumns& c = observation.columns;
  OwnColumns columns;
  columns << c.by_pose, c.by_velocity, c.by_camera * CalibrationPrior::units().asDiagonal(),
      c.by_size * CalibrationPrior::kSizeUnit;
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
  for (std::size_t a = 0; a < parts.size(); ++a) {
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
  for (const Part& part : parts) {
    hessian_.block(first_mode_, part.at, kMapModes, part.count) +=
        mixed.middleCols(part.own, part.count);
  }
  hessian_.block<kMapModes, kMapModes>(first_mode_, first_mode_) +=
      by_modes.transpose() * observation.by_modes;
  right_.segment<kMapModes>(first_mode_) += by_modes.transpose() * residual;
}

/// What the prior says of the numbers in the system; it seldom changes.
void ConsiderPose::invert_prior(const CalibrationPrior& prior) {
  const Eigen::Index numbers = size_ - kMotion;
  auto known = prior_.topLeftCorner(numbers, numbers);
  bool same = numbers == inverted_;
  for (Eigen::Index column = 0; column < numbers; ++column) {
    for (Eigen::Index row = 0; row < numbers; ++row) {
      const double value = prior.covariance()(kept_[static_cast<std::size_t>(row)],
                                              kept_[static_cast<std::size_t>(column)]);
      same = same && known(row, column) == value;
      known(row, column) = value;
    }
  }
  if (same) return;
  inverted_ = numbers;
  factor_.topLeftCorner(numbers, numbers) = known;
  auto factor = factor_.topLeftCorner(numbers, numbers);
  auto information = prior_information_.topLeftCorner(numbers, numbers);
  if (!factor_in_place(factor)) {
    information.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  information.setIdentity();
  solve_in_place(factor, information);
  solve_transposed_in_place(factor, information);
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
  auto h = hessian_.topLeftCorner(size_, size_);
  h.setZero();
  right_.head(size_).setZero();
  invert_prior(prior);
  const auto information = prior_information_.topLeftCorner(numbers, numbers);
  h.bottomRightCorner(numbers, numbers) = information;
  for (Eigen::Index i = 0; i < numbers; ++i) {
    mean_[i] = prior.mean()[kept_[static_cast<std::size_t>(i)]];
  }
  const auto mean = mean_.head(numbers);
  right_.segment(kMotion, numbers).noalias() = information * mean;
  misfit_ = mean.dot(right_.segment(kMotion, numbers));
  h.block<6, 6>(6, 6) = SymmetricFactor<6>(velocity_covariance).inverse();
}

bool ConsiderPose::solve(std::span<const ConsideredObservation> observations,
                         const CalibrationPrior& prior, const Matrix6d& velocity_covariance) {
  observations_ = observations;
  begin(observations, prior, velocity_covariance);
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
  if (!factor_in_place(h)) return false;
  auto x = x_.head(size_);
  x = right_.head(size_);
  solve_in_place(h, x);
  misfit_ -= x.squaredNorm();
  solve_transposed_in_place(h, x);
  auto half = half_.topRows(size_);
  half.setZero();
  half.topRows<kMotion>().setIdentity();
  solve_in_place(h, half);
  of_motion_.setZero();
  add_transposed_product(half, half, of_motion_);
  left_.clear();
  for (const ConsideredObservation& o : observations) left_.push_back(left_by(o));
  return x.allFinite() && of_motion_.allFinite();
}

ConsiderPose::Left ConsiderPose::left_by(const ConsideredObservation& observation) {
  const OwnColumns j = own_columns_of(observation);
  Left left;
  left.residual = observation.columns.residual;
  // L⁻¹ Jᵀ: its square is J C Jᵀ.
  auto columns = columns_.topRows(size_);
  columns.setZero();
  for (const Part& part : parts_of(observation)) {
    columns.middleRows(part.at, part.count) = j.middleCols(part.own, part.count).transpose();
    left.residual.noalias() -= j.middleCols(part.own, part.count) * x_.segment(part.at, part.count);
  }
  if (modes_ > 0) {
    columns.middleRows<kMapModes>(first_mode_) = observation.by_modes.transpose();
    left.residual.noalias() -= observation.by_modes * x_.segment<kMapModes>(first_mode_);
  }
  solve_in_place(hessian_.topLeftCorner(size_, size_), columns);
  left.of_pose.setZero();
  add_transposed_product(columns, columns, left.of_pose);
  left.gain.setZero();
  add_transposed_product(half_.topLeftCorner(size_, 6), columns, left.gain);
  return left;
}

double ConsiderPose::squared_sigmas(std::size_t observation) const {
  const Left& left = left_[observation];
  // Leave-one-out of what carries the pose; the plain sum of what does not.
  const double sign = observations_[observation].used ? -1 : 1;
  const Matrix8d covariance = Matrix8d::Identity() + sign * left.of_pose;
  return left.residual.dot(SymmetricFactor<8>(covariance).solve(left.residual));
}

std::optional<ConsiderPose::Subset> ConsiderPose::without(std::span<const std::size_t> left_out) {
  const auto subset =
      left_out.size() == 1 ? without_one(left_out.front()) : without_several(left_out);
  if (!subset || !subset->covariance.allFinite() || !subset->step.allFinite()) return std::nullopt;
  return subset;
}

std::optional<ConsiderPose::Subset> ConsiderPose::without_one(std::size_t observation) const {
  const Left& left = left_[observation];
  const Eigen::LLT<Matrix8d> factor(Matrix8d::Identity() - left.of_pose);
  if (factor.info() != Eigen::Success) return std::nullopt;
  Subset subset;
  subset.step = step() - left.gain * factor.solve(left.residual);
  subset.covariance = covariance() + left.gain * factor.solve(left.gain.transpose());
  return subset;
}

std::optional<ConsiderPose::Subset> ConsiderPose::without_several(
    std::span<const std::size_t> left_out) {
  auto h = hessian_.topLeftCorner(size_, size_);
  h = information_.topLeftCorner(size_, size_);
  right_.head(size_) = evidence_.head(size_);
  for (const std::size_t o : left_out) add(observations_[o], -1);
  if (!factor_in_place(h)) return std::nullopt;
  // L⁻¹ [e₁ … e₆, b]: products of its columns are the pose's covariance and the pose.
  auto columns = columns_.topLeftCorner(size_, 7);
  columns.setZero();
  columns.topLeftCorner<6, 6>().setIdentity();
  columns.col(6) = right_.head(size_);
  solve_in_place(h, columns);
  Subset subset;
  subset.covariance.setZero();
  add_transposed_product(columns.leftCols<6>(), columns.leftCols<6>(), subset.covariance);
  subset.step.noalias() = columns.leftCols<6>().transpose() * columns.col(6);
  return subset;
}

}  // namespace waymark
