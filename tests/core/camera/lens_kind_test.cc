#include "core/camera/lens_kind.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace waymark {
namespace {

CameraParameters camera_with(Distortion distortion, const LensCoefficients& coefficients) {
  return {640, 480, 400, 400, 319.5, 239.5, distortion, coefficients};
}

TEST(LensKind, StandsInTheOrderOfItsEnumeration) {
  std::set<std::string_view> names;
  for (const LensKind& kind : lens_kinds()) {
    EXPECT_EQ(&lens_kind(kind.distortion), &kind);
    EXPECT_EQ(to_string(kind.distortion), kind.name);
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    EXPECT_LT(kind.first_bend, std::max(1, kind.count()));
    EXPECT_EQ(kind.first_bend < 0, kind.count() == 0);
  }
}

TEST(LensKind, PlainCoefficientsAreThePinholes) {
  for (const LensKind& kind : lens_kinds()) {
    const CameraParameters p = camera_with(kind.distortion, plain_coefficients(kind.distortion));
    const auto model = CameraModel::create(p);
    ASSERT_TRUE(model) << model.error().message;
    const bool straight = kind.distortion != Distortion::equidistant;
    EXPECT_EQ(is_straight(p), straight) << kind.name;
    const Eigen::Vector2d pixel = *model->project({0.3, -0.2, 1});
    EXPECT_EQ((pixel - Eigen::Vector2d(319.5 + 120, 239.5 - 80)).norm() < 1e-9, straight);
  }
  EXPECT_FALSE(is_straight(camera_with(Distortion::radtan5, {0, 0, 0, 0, 0.1})));
}

TEST(LensKind, UsualCoefficientsAreALens) {
  for (const LensKind& kind : lens_kinds()) {
    EXPECT_TRUE(
        CameraModel::create(camera_with(kind.distortion, usual_coefficients(kind.distortion))))
        << kind.name;
    for (const LensCoefficient& one : kind.coefficients) {
      EXPECT_GT(one.spread, 0);
      EXPECT_TRUE(one.range.contains(one.plain) && one.range.contains(one.usual)) << one.name;
    }
  }
}

TEST(LensKind, TheFirstThatBendsLeavesTheAxis) {
  for (const LensKind& kind : lens_kinds()) {
    if (kind.first_bend < 0) continue;
    CameraParameters p = camera_with(kind.distortion, usual_coefficients(kind.distortion));
    const double focal_px = focal_share_at_axis(p) * p.fu_px;
    const Eigen::Vector3d near(1e-5, 0, 1);
    const Eigen::Vector3d far(0.5, 0, 1);
    const CameraModel before = *CameraModel::create(p);
    EXPECT_NEAR(before.project(near)->x() - p.pu_px, 1e-5 * focal_px, 1e-10) << kind.name;
    p.coefficients[static_cast<std::size_t>(kind.first_bend)] += 0.01;
    const CameraModel after = *CameraModel::create(p);
    EXPECT_NEAR(after.project(near)->x(), before.project(near)->x(), 1e-10) << kind.name;
    EXPECT_GT((*after.project(far) - *before.project(far)).norm(), 0.1) << kind.name;
  }
}

TEST(LensKind, TheLeastRadialOneHoldsAListOfCoefficients) {
  const auto kind_of = [](std::vector<double> list) { return radial_kind_of(list); };
  EXPECT_EQ(kind_of({0, 0, 0}), std::nullopt);
  EXPECT_EQ(kind_of({0, 0, 0, 0}), Distortion::radtan);
  EXPECT_EQ(kind_of({1, 0, 0, 0, 0, 0, 0, 0}), Distortion::radtan);
  EXPECT_EQ(kind_of({1, 0, 0, 0, 1, 0, 0, 0}), Distortion::radtan5);
  EXPECT_EQ(kind_of({1, 0, 0, 0, 1, 1}), Distortion::rational);
  EXPECT_EQ(kind_of({1, 0, 0, 0, 1, 1, 1, 1, 0, 0}), Distortion::rational);
  EXPECT_EQ(kind_of({1, 0, 0, 0, 1, 1, 1, 1, 1}), std::nullopt);
}

}  // namespace
}  // namespace waymark
