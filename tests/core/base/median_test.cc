#include "core/base/median.h"

#include <gtest/gtest.h>

#include <chrono>
#include <vector>

namespace waymark {
namespace {

TEST(Median, IsTheMiddleOneOfAnOddNumber) {
  std::vector<double> odd{9, 1, 5};
  EXPECT_EQ(median(odd), 5);
  EXPECT_EQ(upper_median(odd), 5);
  std::vector<double> one{3};
  EXPECT_EQ(median(one), 3);
  EXPECT_EQ(upper_median(one), 3);
}

TEST(Median, OfAnEvenNumberIsTheMeanOfTwoOrTheUpperOne) {
  std::vector<double> even{4, 1, 9, 5};
  EXPECT_EQ(median(even), 4.5);
  EXPECT_EQ(upper_median(even), 5);
}

TEST(Median, IsOfWhateverHasAnOrder) {
  std::vector<std::chrono::nanoseconds> times{std::chrono::seconds(3), std::chrono::seconds(1)};
  EXPECT_EQ(upper_median(times), std::chrono::seconds(3));
  EXPECT_EQ(median(times), std::chrono::seconds(2));
}

}  // namespace
}  // namespace waymark
