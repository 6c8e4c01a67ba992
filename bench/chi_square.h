#pragma once

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <cstddef>
#include <vector>

namespace waymark::bench {

/// Probability that a χ² variable of `freedom` degrees of freedom is at most `value`.
[[nodiscard]] inline double chi_square_cdf(double value, double freedom) {
  return boost::math::gamma_p(0.5 * freedom, 0.5 * value);
}

/// Kolmogorov's distance between a sample of probabilities and the uniform distribution.
[[nodiscard]] inline double kolmogorov_distance(std::vector<double> probabilities) {
  std::sort(probabilities.begin(), probabilities.end());
  const auto count = static_cast<double>(probabilities.size());
  double distance = 0;
  for (std::size_t i = 0; i < probabilities.size(); ++i) {
    const auto rank = static_cast<double>(i);
    distance = std::max(
        {distance, probabilities[i] - rank / count, (rank + 1) / count - probabilities[i]});
  }
  return distance;
}

/// Probability of such a distance or a larger one by chance (asymptotic, with Stephens' correction
/// for small samples).
[[nodiscard]] inline double kolmogorov_p(double distance, std::size_t count) {
  const double root = std::sqrt(static_cast<double>(count));
  const double x = (root + 0.12 + 0.11 / root) * distance;
  double p = 0;
  for (int k = 1; k <= 100; ++k) p += (k % 2 == 1 ? 2 : -2) * std::exp(-2.0 * k * k * x * x);
  return std::clamp(p, 0.0, 1.0);
}

}  // namespace waymark::bench
