#include "core/detect/binomial_smoothing.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(BinomialSmoothing, WeighsNeighbours) {
  GrayImage image(7, 6, 0);
  image.row(3)[2] = 160;
  BinomialSmoothing smoothing;
  const GrayView smooth = smoothing.smoothed(image.view());
  EXPECT_EQ(smooth.row(3)[2], 40);
  EXPECT_EQ(smooth.row(2)[2], 20);
  EXPECT_EQ(smooth.row(3)[3], 20);
  EXPECT_EQ(smooth.row(4)[1], 10);
  EXPECT_EQ(smooth.row(3)[4], 0);
}

TEST(BinomialSmoothing, LeavesWhatIsEvenAlsoAtTheEdges) {
  BinomialSmoothing smoothing;
  for (const auto& [width, height] : {std::pair(9, 5), {1, 1}, {1, 4}, {2, 2}, {40, 3}}) {
    const GrayImage image(width, height, 255);
    const GrayView smooth = smoothing.smoothed(image.view());
    ASSERT_EQ(smooth.width_px, width);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) EXPECT_EQ(smooth.row(y)[x], 255);
    }
  }
}

}  // namespace
}  // namespace waymark
