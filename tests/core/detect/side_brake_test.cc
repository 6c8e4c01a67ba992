#include "core/detect/side_brake.h"

#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

SideStep step_by(double shift_px, double blur_px = 1) {
  SideStep step{};
  step.shift_px.setConstant(shift_px);
  step.appearance.black_grey.setZero();
  step.appearance.white_grey.setConstant(255);
  step.appearance.blur_px = blur_px;
  return step;
}

TEST(SideBrake, StepsThatSettleAreLeftAsTheyAre) {
  SideBrake brake;
  for (const double shift_px : {0.8, 0.3, -0.1, 0.04, 0.01, -0.002}) {
    SideStep step = step_by(shift_px, 0.7);
    brake.slow(step_by(0, 0.9).appearance, step);
    EXPECT_EQ(step.shift_px.x(), shift_px);
    EXPECT_EQ(step.appearance.blur_px, 0.7);
  }
}

TEST(SideBrake, ASideThatSwingsComesToRest) {
  // Sought is 0.1; from either side a step leaps 0.4 px.
  SideBrake brake;
  double place_px = 0;
  double moved_px = 1;
  for (int i = 0; i < 12; ++i) {
    SideStep step = step_by(place_px < 0.1 ? 0.4 : -0.4);
    brake.slow(step.appearance, step);
    moved_px = step.shift_px.x();
    place_px += moved_px;
  }
  EXPECT_NEAR(place_px, 0.1, 0.1);
  EXPECT_LT(std::abs(moved_px), 0.1);
}

TEST(SideBrake, WhatASideLooksLikeSwingsNoFartherThanItself) {
  SideBrake brake;
  SideStep there = step_by(0.4);
  brake.slow(there.appearance, there);
  SideStep back = step_by(-0.4, 0.5);
  brake.slow(there.appearance, back);
  EXPECT_DOUBLE_EQ(back.shift_px.x(), -0.2);
  EXPECT_DOUBLE_EQ(back.appearance.blur_px, 0.75);
}

}  // namespace
}  // namespace waymark
