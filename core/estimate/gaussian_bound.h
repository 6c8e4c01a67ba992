#pragma once

#include <Eigen/Core>
#include <array>

namespace waymark {

/// x with P(X > x) = `tail` of a standard normal X. (0 < tail ≤ ½)
[[nodiscard]] double normal_quantile(double tail);

/// How seldom a bound is to be exceeded, with the lengths of 1, 2 and 3 independent standard
/// normals that are exceeded so seldom.
struct TailRisk {
  explicit TailRisk(double probability);  ///< 1e-12–0.01
  double probability;
  std::array<double, 3> chi;
};

/// A bound that the length of a centred Gaussian vector exceeds with probability ≤ the risk's: by
/// its longest axis where the others are short, by χ where all are alike. N is 1, 2 or 3; infinite
/// for a covariance that is no numbers.
template <int N>
[[nodiscard]] double gaussian_bound(const Eigen::Matrix<double, N, N>& covariance,
                                    const TailRisk& risk);

}  // namespace waymark
