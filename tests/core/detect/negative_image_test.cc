#include "core/detect/negative_image.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(NegativeImage, TurnsGreysAroundAndLeavesPaddingOut) {
  GrayImage image(7, 3, 40);
  image.row(2)[4] = 255;
  GrayView view = image.view();
  view.width_px = 5;
  NegativeImage negative;
  const GrayView turned = negative.of(view);
  EXPECT_EQ(turned.width_px, 5);
  EXPECT_EQ(turned.height_px, 3);
  EXPECT_EQ(turned.row(0)[0], 215);
  EXPECT_EQ(turned.row(2)[4], 0);
}

}  // namespace
}  // namespace waymark
