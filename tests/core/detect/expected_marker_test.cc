#include "core/detect/expected_marker.h"

#include <gtest/gtest.h>

#include <limits>

namespace waymark {
namespace {

TEST(ExpectedMarker, ItsWindowHoldsItHoweverFarOffItIs) {
  ExpectedMarker expected{{}, {{{50, 60}, {90, 62}, {88, 101}, {49, 99}}}, 20};
  const ImageWindow window = window_of(expected);
  EXPECT_LE(window.left_px, 49 - 20 - 8);
  EXPECT_LE(window.top_px, 60 - 20 - 8);
  EXPECT_GE(window.left_px + window.width_px, 90 + 20 + 8);
  EXPECT_GE(window.top_px + window.height_px, 101 + 20 + 8);
  EXPECT_LT(window.area_px2(), 41L * 41 + 4L * 41 * 35 + 4L * 35 * 35 + 500);
}

TEST(ExpectedMarker, WhatIsExpectedNowhereHasAWindowThatCanBeCut) {
  ExpectedMarker expected;
  expected.corners.fill(Eigen::Vector2d(1e300, -1e300));
  const GrayImage image(40, 40);
  EXPECT_EQ(within(image.view(), window_of(expected)).area_px2(), 0);
}

}  // namespace
}  // namespace waymark
