#include "core/estimate/gaussian_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

/// P(X > x) of a standard normal X.
double normal_tail(double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2); }

double normal_density(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi); }

/// P(|v| > x) of three independent standard normals.
double tail_of_three(double x) { return 2 * (normal_tail(x) + x * normal_density(x)); }

/// x at which a falling tail is `risk`.
template <typename Tail>
double quantile(const Tail& tail, double risk) {
  double low = 0;
  double high = 10;  // beyond: 1e-23
  for (int i = 0; i < 32; ++i) {
    const double middle = 0.5 * (low + high);
    (tail(middle) > risk ? low : high) = middle;
  }
  return high;
}

Eigen::Vector2d variances_of(const Eigen::Matrix2d& c) {
  const double mean = 0.5 * c.trace();
  const double half = std::hypot(0.5 * (c(0, 0) - c(1, 1)), c(0, 1));
  return {mean - half, mean + half};
}

Eigen::Vector3d variances_of(const Eigen::Matrix3d& c) { return symmetric_eigen<3>(c).values; }

}  // namespace

TailRisk::TailRisk(double risk)
    : probability(risk),
      chi{normal_quantile(0.5 * risk), std::sqrt(-2 * std::log(risk)),
          quantile(tail_of_three, risk)} {}

double normal_quantile(double tail) { return quantile(normal_tail, tail); }

template <int N>
double gaussian_bound(const Eigen::Matrix<double, N, N>& covariance, const TailRisk& risk) {
  if (!covariance.allFinite()) return std::numeric_limits<double>::infinity();
  if constexpr (N == 1) {
    return std::sqrt(std::max(covariance(0, 0), 0.0)) * risk.chi[0];
  } else {
    const Eigen::Matrix<double, N, 1> variances = variances_of(covariance).cwiseMax(0);
    const double largest = variances[N - 1];
    if (!(largest > 0)) return 0;
    // Far out the tail is that of the longest axis, times what the others add: 1/√Π(1 − λᵢ/λ₁).
    double others = 1;
    for (int i = 0; i + 1 < N; ++i) others *= 1 - variances[i] / largest;
    constexpr double kMargin = 0.75;
    const double share = 0.5 * kMargin * risk.probability * std::sqrt(std::max(others, 0.0));
    const double all = risk.chi[N - 1];
    const double one = share > 0 ? normal_quantile(share) : all;
    return std::sqrt(largest) * std::min(one, all);
  }
}

template double gaussian_bound<1>(const Eigen::Matrix<double, 1, 1>&, const TailRisk&);
template double gaussian_bound<2>(const Eigen::Matrix2d&, const TailRisk&);
template double gaussian_bound<3>(const Eigen::Matrix3d&, const TailRisk&);

}  // namespace waymark
