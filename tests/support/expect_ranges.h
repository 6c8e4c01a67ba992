#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/range.h"
#include "core/geometry/stamp.h"

namespace waymark {

/// A field of an options struct, and the range that its check() holds it to.
template <typename Options>
struct RangedField {
  std::string name;  ///< as the check says it
  Range range;
  std::function<void(Options&, double)> set;
  double step = 0;  ///< to the next number outside; 0: the next double
};

template <typename Options, typename Number>
RangedField<Options> ranged(std::string name, Number Options::*member, Range range) {
  return {
      std::move(name), range,
      [member](Options& options, double value) { options.*member = static_cast<Number>(value); },
      std::is_integral_v<Number> ? 1.0 : 0.0};
}

/// A time, in a unit of so many µs.
template <typename Options>
RangedField<Options> ranged(std::string name, Stamp Options::*member, Range range, double unit_us) {
  return {std::move(name), range,
          [member, unit_us](Options& options, double value) {
            options.*member = from_us(value * unit_us);
          },
          1.0};
}

/// Both ends of every range are taken; what lies next to them is refused by the field's name, and
/// so is NaN.
template <typename Options>
void expect_ranges(const std::vector<RangedField<Options>>& fields) {
  EXPECT_TRUE(Options{}.check());
  for (const RangedField<Options>& field : fields) {
    const auto checked = [&](double value) {
      Options options;
      field.set(options, value);
      return options.check();
    };
    const auto [low, high] = field.range;
    EXPECT_TRUE(checked(low)) << field.name << " = " << low;
    EXPECT_TRUE(checked(high)) << field.name << " = " << high;
    constexpr double kFar = std::numeric_limits<double>::infinity();
    std::vector<double> outside{field.step > 0 ? low - field.step : std::nextafter(low, -kFar),
                                field.step > 0 ? high + field.step : std::nextafter(high, kFar)};
    if (field.step == 0) outside.push_back(std::nan(""));
    for (const double value : outside) {
      const Status refused = checked(value);
      ASSERT_FALSE(refused) << field.name << " = " << value;
      EXPECT_EQ(refused.error().kind, ErrorKind::usage);
      EXPECT_TRUE(refused.error().message.starts_with(field.name + " is "))
          << refused.error().message;
    }
  }
}

}  // namespace waymark
