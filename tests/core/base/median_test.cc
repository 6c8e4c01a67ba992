#include "core/base/median.h"

#include <gtest/gtest.h>

#include <vector>

namespace waymark {
namespace {

TEST(Median, IsTheMiddleOneOfAnOddAndTheUpperOfAnEvenNumber) {
  std::vector<double> odd{9, 1, 5};
  EXPECT_EQ(median(odd), 5);
  std::vector<double> even{4, 1, 9, 5};
  EXPECT_EQ(median(even), 5);
  std::vector<double> one{3};
  EXPECT_EQ(median(one), 3);
}

}  // namespace
}  // namespace waymark
