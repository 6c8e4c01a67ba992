#pragma once

#include <cmath>
#include <vector>

#include "core/base/median.h"

namespace waymark {

/// What all markers of a map show of one quantity: its centre and how far it scatters, both robust,
/// so that a few that stand out change neither.
struct Scatter {
  double centre = 0;
  double spread = 0;  ///< one standard deviation

  /// Whether a value with that sigma lies farther off than all of these can explain.
  [[nodiscard]] bool excludes(double value, double sigma, double least_sigmas) const {
    return std::abs(value - centre) > least_sigmas * std::hypot(spread, sigma);
  }
};

/// Median, and scaled median deviation from it. Of one value at least.
[[nodiscard]] inline Scatter scatter_of(std::vector<double> values) {
  constexpr double kSigmaPerMedianDeviation = 1.4826;
  Scatter scatter;
  scatter.centre = upper_median(values);
  for (double& value : values) value = std::abs(value - scatter.centre);
  scatter.spread = kSigmaPerMedianDeviation * upper_median(values);
  return scatter;
}

}  // namespace waymark
