#include "mapbuilder/calibrate/image_coverage.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

std::vector<Eigen::Vector2d> corners_over(double left, double right) {
  std::vector<Eigen::Vector2d> corners;
  for (double x = left; x < right; x += 50) {
    for (double y = 20; y < 960; y += 50) corners.emplace_back(x, y);
  }
  return corners;
}

const CameraModel& camera() {
  static const Rig rig = test::ring_rig(1);
  return rig.cameras.front().model;
}

TEST(ImageCoverage, OfAnImageFullOfMarkersMissesNothing) {
  const auto coverage = image_coverage("cam0", camera(), corners_over(10, 1280));
  EXPECT_EQ(coverage.share, 1);
  EXPECT_TRUE(coverage.empty.empty());
  EXPECT_TRUE(findings_of(coverage).empty());
}

TEST(ImageCoverage, NamesTheThirdThatNoMarkerWasSeenIn) {
  const auto coverage = image_coverage("cam1", camera(), corners_over(450, 1280));
  ASSERT_EQ(coverage.empty, std::vector<std::string>{"left"});
  EXPECT_LT(coverage.share, 0.8);
  const auto findings = findings_of(coverage);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].text.rfind("no marker in the left third of cam1", 0), 0U);
  EXPECT_EQ(findings[0].severity, Severity::warning);
}

TEST(ImageCoverage, OfNoCornersMissesEverything) {
  const auto coverage = image_coverage("cam0", camera(), {});
  EXPECT_EQ(coverage.share, 0);
  EXPECT_EQ(coverage.empty.size(), 6U);
}

}  // namespace
}  // namespace waymark
