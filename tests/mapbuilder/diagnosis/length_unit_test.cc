#include "mapbuilder/diagnosis/length_unit.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(LengthUnit, IsToldWithinFourPercent) {
  for (const LengthUnit& unit : kLengthUnits) {
    for (const double factor : {0.961, 1.0, 1.039}) {
      const auto told = unit_of(factor * unit.per_metre);
      ASSERT_TRUE(told) << unit.name << " × " << factor;
      EXPECT_STREQ(told->name, unit.name);
    }
    EXPECT_FALSE(unit_of(0.959 * unit.per_metre)) << unit.name;
    EXPECT_FALSE(unit_of(1.041 * unit.per_metre)) << unit.name;
  }
  EXPECT_FALSE(unit_of(1.0));
}

}  // namespace
}  // namespace waymark
