#include "core/base/range.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace waymark {
namespace {

TEST(Range, HoldsItsEndsAndNoNaN) {
  constexpr Range kRange{3, 100};
  EXPECT_TRUE(kRange.contains(3));
  EXPECT_TRUE(kRange.contains(100));
  EXPECT_FALSE(kRange.contains(std::nextafter(3.0, 0.0)));
  EXPECT_FALSE(kRange.contains(std::nextafter(100.0, 200.0)));
  EXPECT_FALSE(kRange.contains(std::nan("")));
  EXPECT_FALSE(kRange.contains(std::numeric_limits<double>::infinity()));
}

TEST(RangeCheck, NamesTheFirstFieldThatIsOutside) {
  EXPECT_TRUE(RangeCheck().field("a", 1, {0, 2}).field("b", 2, {0, 2}).status());
  const Status wrong = RangeCheck()
                           .field("a", 1, {0, 2})
                           .field("b", std::nan(""), {0, 2})
                           .field("c", 5, {0, 2})
                           .status();
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().kind, ErrorKind::usage);
  EXPECT_EQ(wrong.error().message, "b is nan; it must be from 0 to 2");
}

TEST(NumberIn, TakesNumbersOfTheRangeAndNothingElse) {
  const auto fault = number_in({3, 100});
  for (const char* good : {"3", "100", "+20", "5.5", "2e1"}) EXPECT_EQ(fault(good), "") << good;
  for (const char* bad : {"nan", "-nan", "inf", "1e999", "2.99", "101", "", " 5", "5x", "five"}) {
    EXPECT_EQ(fault(bad), fmt::format("{} is no number from 3 to 100", bad));
  }
}

TEST(RangeCheck, NamesAPartsFieldBehindThePart) {
  const Status inner = RangeCheck().field("b", 3, {0, 2}).status();
  const Status outer = RangeCheck().part("a", inner).field("c", 5, {0, 2}).status();
  ASSERT_FALSE(outer);
  EXPECT_EQ(outer.error().message, "a.b is 3; it must be from 0 to 2");
  EXPECT_TRUE(RangeCheck().part("a", Status{}).status());
}

}  // namespace
}  // namespace waymark
