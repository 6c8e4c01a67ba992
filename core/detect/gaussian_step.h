#pragma once

namespace waymark {

/// The normal distribution function and its density.
struct GaussianStep {
  double value = 0;
  double slope = 0;
};

/// To 2e-6, from a table; 0 and 1 beyond 5 standard deviations.
[[nodiscard]] GaussianStep gaussian_step(double x);

}  // namespace waymark
