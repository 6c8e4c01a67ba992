#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/median.h"

namespace waymark {

/// One quantity of one marker.
struct Measured {
  double value = 0;
  double sigma = 0;
};

/// What all markers of a map show of one quantity, robustly, so that a few that stand out change
/// neither number.
struct Scatter {
  double centre = 0;
  /// One standard deviation of what lies behind the measured values: their spread less their
  /// sigmas.
  double spread = 0;

  /// Whether a value lies farther off than its sigma and all others explain.
  [[nodiscard]] bool excludes(const Measured& one, double least_sigmas) const {
    return std::abs(one.value - centre) > least_sigmas * std::hypot(spread, one.sigma);
  }
};

/// By medians: of the values, of their distances from it, of their sigmas. Of one value at least.
[[nodiscard]] inline Scatter scatter_of(const std::vector<Measured>& all) {
  constexpr double kSigmaPerMedianDeviation = 1.4826;
  std::vector<double> values;
  std::vector<double> sigmas;
  for (const Measured& one : all) {
    values.push_back(one.value);
    sigmas.push_back(one.sigma);
  }
  const double centre = upper_median(values);
  for (double& value : values) value = std::abs(value - centre);
  const double seen = kSigmaPerMedianDeviation * upper_median(values);
  const double measured = upper_median(sigmas);
  return {centre, std::sqrt(std::max(0.0, seen * seen - measured * measured))};
}

}  // namespace waymark
