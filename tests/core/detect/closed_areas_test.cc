#include "core/detect/closed_areas.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(ClosedAreas, DivideAnImageBetweenItsTwoLevels) {
  GrayImage image(40, 40, 60);
  for (int y = 0; y < 12; ++y) std::fill(image.row(y), image.row(y) + 40, std::uint8_t{200});
  image.row(20)[20] = 65;
  const int grey = dividing_grey(image.view());
  EXPECT_GE(grey, 65);
  EXPECT_LT(grey, 200);
}

TEST(ClosedAreas, GapsOfTwiceTheRadiusAreFilledAndWiderOnesAreNot) {
  GrayImage image(80, 30, 0);
  for (int y = 8; y < 22; ++y) {
    for (const int x : {10, 11, 12, 19, 20, 21, 40, 41}) image.row(y)[x] = 255;
  }
  const GrayImage filled = closed(image, 3);  // 6 px lie between 12 and 19, 18 after 21
  EXPECT_EQ(filled.row(15)[15], 255);
  EXPECT_EQ(filled.row(15)[30], 0);
  EXPECT_EQ(filled.row(15)[9], 0) << "areas do not grow";
  EXPECT_EQ(filled.row(7)[11], 0);
  EXPECT_EQ(closed(GrayImage(1, 1, 255), 12).pixels[0], 255);
}

}  // namespace
}  // namespace waymark
