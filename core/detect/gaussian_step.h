#pragma once

#include <array>
#include <cstddef>

namespace waymark {

/// The normal distribution function and its density.
struct GaussianStep {
  double value = 0;
  double slope = 0;
};

/// Both functions at x = i / kPerUnit − kReach.
struct GaussianTable {
  static constexpr double kReach = 5;
  static constexpr int kPerUnit = 128;
  static constexpr std::size_t kCount = static_cast<std::size_t>(2 * kReach) * kPerUnit + 1;

  GaussianTable();
  std::array<GaussianStep, kCount> steps;
};

extern const GaussianTable kGaussianTable;

/// To 2e-6, from the table; 0 and 1 beyond 5 standard deviations.
[[nodiscard]] inline GaussianStep gaussian_step(double x) {
  if (!(x > -GaussianTable::kReach)) return {0, 0};
  if (x >= GaussianTable::kReach) return {1, 0};
  const double place = (x + GaussianTable::kReach) * GaussianTable::kPerUnit;
  const auto i = static_cast<std::size_t>(place);
  const double t = place - static_cast<double>(i);
  const GaussianStep& a = kGaussianTable.steps[i];
  const GaussianStep& b = kGaussianTable.steps[i + 1];
  return {a.value + t * (b.value - a.value), a.slope + t * (b.slope - a.slope)};
}

}  // namespace waymark
