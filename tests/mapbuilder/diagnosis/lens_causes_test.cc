#include "mapbuilder/diagnosis/lens_causes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace waymark {
namespace {

using testing::HasSubstr;

CameraParameters webcam() {
  CameraParameters p;
  p.width_px = 1280;
  p.height_px = 720;
  p.fu_px = 905;
  p.fv_px = 907;
  p.pu_px = 651;
  p.pv_px = 342;
  p.distortion = Distortion::radtan;
  p.coefficients = {-0.21, 0.08, 0.001, -0.0005};
  return p;
}

CameraParameters scaled(CameraParameters p, double factor) {
  p.fu_px *= factor;
  p.fv_px *= factor;
  p.pu_px = (p.pu_px + 0.5) * factor - 0.5;
  p.pv_px = (p.pv_px + 0.5) * factor - 0.5;
  return p;
}

TEST(LensCauses, WhatACalibrationLeavesIsNoCause) {
  CameraParameters fitted = webcam();
  EXPECT_FALSE(explain_lens(webcam(), fitted));
  fitted.fu_px *= 1.01;
  fitted.fv_px *= 1.012;
  fitted.pu_px += 2.5;
  fitted.coefficients[0] += 0.002;
  EXPECT_FALSE(explain_lens(webcam(), fitted));
}

TEST(LensCauses, AnotherResolutionIsToldWithItsFactor) {
  for (const auto& [factor, text] :
       {std::pair{2.0, "half the resolution"}, std::pair{0.5, "double the resolution"},
        std::pair{1.5, "0.667 of the resolution"}}) {
    CameraParameters fitted = scaled(webcam(), factor);
    fitted.fu_px *= 1.008;
    const auto why = explain_lens(webcam(), fitted);
    ASSERT_TRUE(why);
    EXPECT_EQ(why->cause, Cause::resolution);
    EXPECT_THAT(why->detail, HasSubstr(text));
  }
}

TEST(LensCauses, AFocalLengthThatFitsNoOtherSizeIsToldInPercent) {
  for (const double factor : {0.77, 0.9, 1.05, 1.3}) {
    CameraParameters fitted = webcam();
    fitted.fu_px *= factor;
    fitted.fv_px *= factor;
    const auto why = explain_lens(webcam(), fitted);
    ASSERT_TRUE(why);
    EXPECT_EQ(why->cause, Cause::intrinsics);
    EXPECT_NEAR(why->value, 100 * (factor - 1), 0.01);
  }
}

TEST(LensCauses, NumbersInAnotherOrderAreRecognized) {
  CameraParameters stated = webcam();
  std::swap(stated.fu_px, stated.pu_px);
  std::swap(stated.fv_px, stated.pv_px);
  const auto why = explain_lens(stated, webcam());
  ASSERT_TRUE(why);
  EXPECT_EQ(why->cause, Cause::intrinsics);
  EXPECT_THAT(why->detail, HasSubstr("[cx cy fx fy]"));
}

// fu pu fv pv and other orders put a focal length where the principal point stands.
TEST(LensCauses, APrincipalPointOutsideOfTheImageIsAnotherOrder) {
  const CameraParameters true_one = webcam();
  CameraParameters stated = true_one;
  std::swap(stated.fv_px, stated.pu_px);
  CameraParameters other = true_one;
  std::swap(other.fu_px, other.pv_px);
  for (const CameraParameters& wrong : {stated, other}) {
    if (wrong.pu_px < wrong.width_px && wrong.pv_px < wrong.height_px) continue;
    const auto why = explain_lens(wrong, true_one);
    ASSERT_TRUE(why);
    EXPECT_EQ(why->cause, Cause::intrinsics);
    EXPECT_THAT(why->detail, HasSubstr("lies outside of the image"));
    EXPECT_THAT(why->remedy, HasSubstr("fu, fv, pu, pv"));
  }
}

TEST(LensCauses, ImagesScaledInOneDirectionAreToldBySide) {
  for (const double squeeze : {0.75, 1.12, 1.333}) {
    CameraParameters fitted = webcam();
    fitted.fv_px *= squeeze;
    fitted.pv_px *= squeeze;
    const auto why = explain_lens(webcam(), fitted);
    ASSERT_TRUE(why);
    EXPECT_EQ(why->cause, Cause::resolution);
    EXPECT_THAT(why->detail, HasSubstr(squeeze < 1 ? "below fu" : "above fu"));
  }
}

TEST(LensCauses, TurnedImagesShowInThePrincipalPoint) {
  CameraParameters fitted = webcam();
  fitted.pu_px = webcam().width_px - 1 - webcam().pu_px;
  fitted.pv_px = webcam().height_px - 1 - webcam().pv_px;
  const auto why = explain_lens(webcam(), fitted);
  ASSERT_TRUE(why);
  EXPECT_EQ(why->cause, Cause::images_turned);
}

TEST(LensCauses, ACropMovesThePrincipalPointElsewhere) {
  CameraParameters fitted = webcam();
  fitted.pu_px += 120;
  fitted.pv_px -= 40;
  const auto why = explain_lens(webcam(), fitted);
  ASSERT_TRUE(why);
  EXPECT_EQ(why->cause, Cause::crop);
}

TEST(LensCauses, ACropNearWhereATurnWouldPutThePrincipalPointIsACrop) {
  CameraParameters stated = webcam();
  stated.pu_px = (stated.width_px - 1) / 2.0 - 10;  // turned: 20 px on
  stated.pv_px = (stated.height_px - 1) / 2.0;
  CameraParameters fitted = stated;
  fitted.pu_px += 30;
  fitted.pv_px += 28;
  const auto why = explain_lens(stated, fitted);
  ASSERT_TRUE(why);
  EXPECT_EQ(why->cause, Cause::crop);
}

TEST(LensCauses, RectifiedImagesBendNoMore) {
  CameraParameters fitted = webcam();
  fitted.coefficients = {-0.004, 0.001, 0, 0};
  const auto why = explain_lens(webcam(), fitted);
  ASSERT_TRUE(why);
  EXPECT_EQ(why->cause, Cause::rectified);
}

TEST(LensCauses, AnotherLensIsToldByHowFarItBends) {
  CameraParameters stated = webcam();
  stated.coefficients = {};
  const auto why = explain_lens(stated, webcam());
  ASSERT_TRUE(why);
  EXPECT_EQ(why->cause, Cause::intrinsics);
  EXPECT_GT(why->value, 10);
}

}  // namespace
}  // namespace waymark
