#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/base/check.h"

namespace waymark {

/// The middle of the values (of an even number the upper one of two), which it puts into another
/// order. There must be one at least.
[[nodiscard]] inline double median(std::span<double> values) {
  WAYMARK_CHECK(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace waymark
