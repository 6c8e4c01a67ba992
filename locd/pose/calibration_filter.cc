#include "locd/pose/calibration_filter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/dense_products.h"

namespace waymark {
namespace {

/// What calibrations change by in the root of an hour: place, rotation, focal length, principal
/// point, first coefficient, edges, clock, read-out.
CalibrationVector walk_per_root_hour() {
  constexpr double kRadPerDeg = std::numbers::pi / 180.0;
  CalibrationVector walk;
  walk << Eigen::Vector3d::Constant(2e-4), Eigen::Vector3d::Constant(0.01 * kRadPerDeg), 2e-4, 0.1,
      0.1, 5e-4, 0, 1e-4, 1e-5;
  return walk;
}

/// χ² of n freedoms that is exceeded once in a thousand (Wilson and Hilferty 1931).
double chi_square_at_999(double n) {
  constexpr double kNormalAt999 = 3.0902;
  const double share = 2 / (9 * n);
  return n * std::pow(1 - share + kNormalAt999 * std::sqrt(share), 3);
}

/// Numbers of which a block says hardly anything are told by this (units of usual sigmas, squared).
constexpr double kLeastInformation = 1e-8;
constexpr double kSigmasOfACalibration = 3;

}  // namespace

CalibrationFilter::CalibrationFilter(const CalibrationPrior& stated, const MapIndex& map)
    : stated_(stated), learnt_(stated), map_(map), counted_(map.size(), 0) {
  const Eigen::Index shared = stated.size();
  const Eigen::Index own = 6 * static_cast<Eigen::Index>(Evidence::kMostMarkers);
  own_information_.setZero(own, own);
  crossed_.setZero(own, shared);
  own_evidence_.setZero(own);
  seen_.reserve(Evidence::kMostMarkers);
  for (Eigen::MatrixXd* square :
       {&information_, &innovation_, &gain_, &left_, &product_, &covariance_}) {
    square->setZero(shared, shared);
  }
  evidence_.setZero(shared);
  step_.setZero(shared);
  mean_.setZero(shared);
}

void CalibrationFilter::reset() {
  learnt_ = stated_;
  applied_ = false;
  blocks_ = 0;
}

bool CalibrationFilter::take(const Evidence::System& block, Stamp stamp) {
  walk(stamp);
  const bool taken = reduce(block) && update();
  if (taken) ++blocks_;
  applied_ = blocks_ > 0 && within_reason();
  return taken;
}

/// Nothing becomes less sure than it was stated.
void CalibrationFilter::walk(Stamp stamp) {
  constexpr double kHour_s = 3600;
  const double hours = blocks_ > 0 ? std::max(0.0, in_s(stamp - last_)) / kHour_s : 0;
  last_ = stamp;
  if (hours == 0) return;
  static const CalibrationVector kWalk =
      walk_per_root_hour().cwiseQuotient(CalibrationPrior::units());
  covariance_ = learnt_.covariance();
  for (std::size_t c = 0; c < stated_.cameras(); ++c) {
    for (Eigen::Index i = 0; i < kCalibrationNumbers; ++i) {
      const Eigen::Index at = CalibrationPrior::first_of(c) + i;
      const double room = std::max(0.0, stated_.covariance()(at, at) - covariance_(at, at));
      covariance_(at, at) += std::min(kWalk[i] * kWalk[i] * hours, room);
    }
  }
  mean_ = learnt_.mean();
  learnt_.learn(mean_, covariance_);
}

/// Where the block's markers stand, and what each errs by on its own: root · u, u of unit variance.
void CalibrationFilter::take_roots(const Evidence::System& block) {
  constexpr double kLeastVariance = 1e-16;
  seen_.clear();
  for (std::size_t slot = 0; slot < block.views.size(); ++slot) {
    const std::size_t marker = block.markers[slot];
    counted_[marker] += block.views[slot];
    Matrix6d covariance = counted_[marker] * map_.own_covariance(marker);
    covariance.diagonal().array() += kLeastVariance;
    seen_.push_back({marker, stated_.numbers() + 6 * static_cast<Eigen::Index>(slot),
                     Matrix6d(covariance.llt().matrixL())});
  }
}

bool CalibrationFilter::reduce(const Evidence::System& block) {
  take_roots(block);
  if (seen_.empty()) return false;
  const Eigen::Index numbers = stated_.numbers();
  const bool modes = stated_.modes() > 0;
  information_.setZero();
  information_.topLeftCorner(numbers, numbers) = block.information.topLeftCorner(numbers, numbers);
  evidence_.setZero();
  evidence_.head(numbers) = block.evidence.head(numbers);
  crossed_.setZero();
  Eigen::Index row = 0;
  for (const Seen& a : seen_) {
    auto crossed = crossed_.middleRows<6>(row);
    crossed.leftCols(numbers).noalias() =
        a.root.transpose() * block.information.block(a.at, 0, 6, numbers);
    own_evidence_.segment<6>(row).noalias() = a.root.transpose() * block.evidence.segment<6>(a.at);
    const Modes of_a = map_.marker(a.marker).modes.cast<double>();
    Eigen::Index column = 0;
    for (const Seen& b : seen_) {
      const Matrix6d both = block.information.block<6, 6>(a.at, b.at);
      own_information_.block<6, 6>(row, column).noalias() = a.root.transpose() * both * b.root;
      column += 6;
      if (!modes) continue;
      const Modes by_b = both * map_.marker(b.marker).modes.cast<double>();
      crossed.rightCols<kMapModes>().noalias() += a.root.transpose() * by_b;
      information_.bottomRightCorner<kMapModes, kMapModes>().noalias() += of_a.transpose() * by_b;
    }
    row += 6;
    if (!modes) continue;
    information_.bottomLeftCorner(kMapModes, numbers).noalias() +=
        of_a.transpose() * block.information.block(a.at, 0, 6, numbers);
    evidence_.tail<kMapModes>().noalias() += of_a.transpose() * block.evidence.segment<6>(a.at);
  }
  if (modes) {
    information_.topRightCorner(numbers, kMapModes) =
        information_.bottomLeftCorner(kMapModes, numbers).transpose();
  }
  // Each marker's own error goes.
  auto of_own = own_information_.topLeftCorner(row, row);
  auto crossed = crossed_.topRows(row);
  of_own.diagonal().array() += 1;
  if (!factor_in_place(of_own)) return false;
  solve_in_place(of_own, crossed);
  solve_in_place(of_own, own_evidence_.head(row));
  product_.setZero();
  add_transposed_product(crossed, crossed, product_);
  information_ -= product_;
  evidence_.noalias() -= crossed.transpose() * own_evidence_.head(row);
  return true;
}

/// The block as a measurement y = E s with unit noise, EᵀE its information; Joseph's form, with the
/// gain of what is considered zero.
bool CalibrationFilter::update() {
  const Eigen::Index size = stated_.size();
  const Eigen::Index learnt = CalibrationPrior::first_of(stated_.cameras());
  // E is upper triangular: the transposed Cholesky factor.
  information_.diagonal().array() += kLeastInformation;
  if (!factor_in_place(information_)) return false;
  information_.triangularView<Eigen::StrictlyUpper>().setZero();
  const Eigen::MatrixXd& lower = information_;
  const Eigen::MatrixXd& before = learnt_.covariance();
  // ν = E⁻ᵀ b − E ŝ
  step_ = evidence_;
  solve_in_place(lower, step_);
  step_.noalias() -= lower.transpose() * learnt_.mean();
  // Π Eᵀ, and Y = E Π Eᵀ + I.
  left_.setZero();
  add_product(before, lower, left_);
  innovation_.setIdentity();
  add_transposed_product(lower, left_, innovation_);
  if (!factor_in_place(innovation_)) return false;
  // X = Π Eᵀ Y⁻¹, as its transpose.
  gain_ = left_.transpose();
  solve_in_place(innovation_, gain_);
  mean_ = step_;
  solve_in_place(innovation_, mean_);
  if (!(mean_.squaredNorm() <= chi_square_at_999(static_cast<double>(size)))) return false;
  solve_transposed_in_place(innovation_, gain_);
  gain_.rightCols(size - learnt).setZero();
  mean_ = learnt_.mean();
  mean_.noalias() += gain_.transpose() * step_;
  // (I − X E) Π (I − X E)ᵀ + X Xᵀ
  product_ = lower.transpose();
  left_.setZero();
  add_transposed_product(gain_, product_, left_);
  product_.setIdentity();
  product_ -= left_;
  covariance_.setZero();
  left_.setZero();
  add_product(product_, before, left_);
  product_.transposeInPlace();
  add_product(left_, product_, covariance_);
  add_transposed_product(gain_, gain_, covariance_);
  product_ = covariance_.transpose();
  covariance_ = 0.5 * (covariance_ + product_);
  if (!mean_.allFinite() || !covariance_.allFinite()) return false;
  learnt_.learn(mean_, covariance_);
  return true;
}

bool CalibrationFilter::within_reason() const {
  const Eigen::Index learnt = CalibrationPrior::first_of(stated_.cameras());
  const auto sigmas = stated_.covariance().diagonal().head(learnt).cwiseSqrt();
  return (learnt_.mean().head(learnt).cwiseAbs().array() <= kSigmasOfACalibration * sigmas.array())
      .all();
}

}  // namespace waymark
