#include "mapbuilder/bundle/sensitivity_modes.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

constexpr int kRounds = 5;
constexpr int kSubspaceRounds = 3;
/// Of the largest eigenvalue: smaller is rounding.
constexpr double kNegligible = 1e-12;

/// What `count` directions leave out of each marker.
class ModeFit {
 public:
  explicit ModeFit(const Eigen::MatrixXd& sensitivity)
      : sensitivity_(sensitivity), variance_(sensitivity.rows() / 6) {
    for (Eigen::Index i = 0; i < variance_.size(); ++i) {
      variance_[i] = sensitivity.middleRows<6>(6 * i).squaredNorm() / 6;
    }
  }

  [[nodiscard]] SensitivityModes with(int count) const {
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(variance_.size());
    SensitivityModes modes = fitted(count, weights);
    for (int round = 0; round < kRounds && !good(modes); ++round) {
      const Eigen::VectorXd dropped = dropped_by(modes);
      const double mean = dropped.mean();
      if (!(mean > 0)) break;
      weights.array() *= (dropped.array() / mean).max(0.3).sqrt();
      modes = fitted(count, weights);
    }
    return modes;
  }

  [[nodiscard]] static bool good(const SensitivityModes& modes) {
    return modes.dropped_mean <= kDroppedMean && modes.dropped_worst <= kDroppedWorst;
  }

 private:
  [[nodiscard]] SensitivityModes fitted(int count, const Eigen::VectorXd& weights) const {
    SensitivityModes modes;
    const Eigen::Index size = sensitivity_.cols();
    if (count == 0) {
      modes.directions.resize(size, 0);
    } else {
      const Eigen::VectorXd roots = weights.cwiseSqrt().replicate(1, 6).transpose().reshaped();
      const Eigen::MatrixXd weighted = roots.asDiagonal() * sensitivity_;
      const Eigen::MatrixXd sum = weighted.transpose() * weighted;
      modes.directions = symmetric_eigen<Eigen::Dynamic>(sum).vectors.rightCols(count);
    }
    const Eigen::VectorXd dropped = dropped_by(modes);
    modes.dropped_mean = dropped.mean();
    modes.dropped_worst = dropped.maxCoeff();
    return modes;
  }

  [[nodiscard]] Eigen::VectorXd dropped_by(const SensitivityModes& modes) const {
    if (modes.directions.cols() == 0) return variance_;
    const Eigen::MatrixXd kept = sensitivity_ * modes.directions;
    Eigen::VectorXd dropped = variance_;
    for (Eigen::Index i = 0; i < dropped.size(); ++i) {
      dropped[i] = std::max(0.0, dropped[i] - kept.middleRows<6>(6 * i).squaredNorm() / 6);
    }
    return dropped;
  }

  const Eigen::MatrixXd& sensitivity_;
  Eigen::VectorXd variance_;
};

/// Numbers within ±1 that are the same on every machine.
Eigen::MatrixXd fixed_start(Eigen::Index rows, Eigen::Index columns) {
  std::mt19937_64 random(1);
  Eigen::MatrixXd start(rows, columns);
  for (Eigen::Index column = 0; column < columns; ++column) {
    for (Eigen::Index row = 0; row < rows; ++row) {
      start(row, column) = std::ldexp(static_cast<double>(random() >> 11U), -52) - 1;
    }
  }
  return start;
}

/// Each marker's rows by its own matrix.
template <typename Matrix>
Eigen::MatrixXd by_blocks(const std::vector<Matrix6d>& blocks, Eigen::MatrixXd x, Matrix matrix) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    auto rows = x.middleRows<6>(static_cast<Eigen::Index>(6 * i));
    rows = (matrix(blocks[i]) * rows).eval();
  }
  return x;
}

Eigen::MatrixXd into_sigmas(const std::vector<Matrix6d>& roots, Eigen::MatrixXd x) {
  return by_blocks(roots, std::move(x), [](const Matrix6d& r) -> const Matrix6d& { return r; });
}

Eigen::MatrixXd transposed_into_sigmas(const std::vector<Matrix6d>& roots, Eigen::MatrixXd x) {
  return by_blocks(roots, std::move(x), [](const Matrix6d& r) { return r.transpose(); });
}

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& x) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(x);
  return qr.householderQ() * Eigen::MatrixXd::Identity(x.rows(), x.cols());
}

}  // namespace

SensitivityModes sensitivity_modes(const Eigen::MatrixXd& sensitivity, int most) {
  const ModeFit fit(sensitivity);
  int high = static_cast<int>(std::min<Eigen::Index>(most, sensitivity.cols()));
  SensitivityModes best = fit.with(high);
  int low = 0;
  while (low < high && ModeFit::good(best)) {
    const int middle = (low + high) / 2;
    const SensitivityModes fewer = fit.with(middle);
    if (ModeFit::good(fewer)) {
      high = middle;
      best = fewer;
    } else {
      low = middle + 1;
    }
  }
  return best;
}

Eigen::MatrixXd leading_columns(const CovarianceTimes& covariance_times,
                                const std::vector<Matrix6d>& roots, int count) {
  const auto rows = static_cast<Eigen::Index>(6 * roots.size());
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows, count);
  const int rank = static_cast<int>(std::min<Eigen::Index>(count, rows));
  if (rank == 0) return columns;
  Eigen::MatrixXd q = orthonormal(fixed_start(rows, rank));
  for (int round = 0; round < kSubspaceRounds; ++round) {
    q = orthonormal(
        into_sigmas(roots, covariance_times(transposed_into_sigmas(roots, std::move(q)))));
  }
  q = transposed_into_sigmas(roots, std::move(q));
  const Eigen::MatrixXd answer = covariance_times(q);
  const Eigen::MatrixXd core = q.transpose() * answer;
  const SymmetricEigen<Eigen::Dynamic> eigen =
      symmetric_eigen<Eigen::Dynamic>(0.5 * (core + core.transpose()));
  const double least = kNegligible * std::max(0.0, eigen.values[rank - 1]);
  for (int k = 0; k < rank; ++k) {
    const int from = rank - 1 - k;
    if (!(eigen.values[from] > least)) break;
    columns.col(k) = answer * (eigen.vectors.col(from) / std::sqrt(eigen.values[from]));
  }
  return columns;
}

Matrix6d inverse_root(const Matrix6d& covariance) {
  // By its own sigmas first: metres and radians do not compare.
  const Vector6d sigmas = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  const Vector6d scale = (sigmas.array() > 0).select(sigmas.cwiseInverse(), Vector6d::Zero());
  const SymmetricEigen<6> eigen =
      symmetric_eigen<6>(Matrix6d(scale.asDiagonal() * covariance * scale.asDiagonal()));
  constexpr double kLeast = 1e-9;  // of correlations: less is a direction that is not there
  const Vector6d inverse =
      (eigen.values.array() > kLeast)
          .select(eigen.values.cwiseMax(kLeast).cwiseSqrt().cwiseInverse(), Vector6d::Zero());
  return inverse.asDiagonal() * eigen.vectors.transpose() * scale.asDiagonal();
}

}  // namespace waymark
