#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "core/base/check.h"

namespace waymark {

/// The middle one of the values (of an even number the upper one of two), which it puts into
/// another order. There must be one at least (checked).
template <typename Values>
[[nodiscard]] auto upper_median(Values& values) {
  WAYMARK_CHECK(!std::empty(values));
  const auto middle = std::begin(values) + static_cast<std::ptrdiff_t>(std::size(values) / 2);
  std::nth_element(std::begin(values), middle, std::end(values));
  return *middle;
}

/// The same, of an even number the mean of the two in the middle: what expectations are known of.
template <typename Values>
[[nodiscard]] auto median(Values& values) {
  const auto upper = upper_median(values);
  if (std::size(values) % 2 == 1) return upper;
  const auto middle = std::begin(values) + static_cast<std::ptrdiff_t>(std::size(values) / 2);
  return (upper + *std::max_element(std::begin(values), middle)) / 2;
}

/// Medians of χ² by degrees of freedom: of squared residuals in sigmas, where sigmas are right.
inline constexpr double kMedianOfChi2_2 = 1.386;
inline constexpr double kMedianOfChi2_3 = 2.366;
inline constexpr double kMedianOfChi2_5 = 4.351;
inline constexpr double kMedianOfChi2_6 = 5.348;
inline constexpr double kMedianOfChi2_8 = 7.344;

/// Median of |x|, x normal with sigma 1.
inline constexpr double kMedianOfNormal = 0.6745;

}  // namespace waymark
