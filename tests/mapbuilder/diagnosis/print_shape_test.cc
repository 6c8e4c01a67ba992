#include "mapbuilder/diagnosis/print_shape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/mapbuilder/diagnosis/seen_rooms.h"

namespace waymark {
namespace {

DetectedCapture seen(double stretch) {
  test::RoomOptions options;
  options.markers = 20;
  options.frame_sets = 20;
  options.cameras = 1;
  const auto room = test::make_room(options);
  return test::seen_room(room, test::rig_of(test::kRigKinds[0]), 0.1, 1, stretch);
}

TEST(PrintShape, CornersOfASquareAreThoseOfTheStretchedPrintMovedInItsPlane) {
  // Seen from aslant, whatever the lens does.
  const auto square = seen(1.0);
  const CameraModel& camera =
      square.rig.cameras[static_cast<std::size_t>(square.images.front().camera)].model;
  ImageCorners corners = square.images.front().detections.front().corners;
  for (const double stretch : {-0.05, 0.02, 0.08}) {
    const ImageCorners there = as_square(camera, corners, stretch);
    const ImageCorners back = as_square(camera, there, -stretch);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((back[i] - corners[i]).norm(), 1e-6);
    const double width = (there[1] - there[0]).norm() / (corners[1] - corners[0]).norm();
    EXPECT_EQ(width<1, stretch> 0);
  }
}

TEST(PrintShape, AStretchIsFoundWithItsSign) {
  for (const double stretch : {0.97, 1.02}) {
    const auto shape = fit_print_shape({seen(stretch)});
    ASSERT_TRUE(shape);
    EXPECT_NEAR(shape->stretch, std::log(stretch), 5 * shape->sigma + 0.0005);
    EXPECT_LT(shape->sigma, 0.003);
    EXPECT_NEAR(shape->own_px, 0.1, 0.02);
    const Finding finding = finding_of(*shape, FitQuality{0.1, 0.1, 0.1}, 0.6);
    EXPECT_EQ(finding.cause, Cause::print_not_square);
    EXPECT_THAT(finding.text,
                testing::HasSubstr(stretch < 1 ? "narrower than high" : "lower than wide"));
  }
}

TEST(PrintShape, SquaresAreNotStretched) { EXPECT_FALSE(fit_print_shape({seen(1.0)})); }

}  // namespace
}  // namespace waymark
