#include "mapbuilder/calibrate/lens_growth.h"

#include "tests/mapbuilder/calibrate/unknown_room.h"
#include "tests/support/other_lens.h"

namespace waymark {
namespace {

std::optional<GrownLens> grown(const test::SyntheticRoom& room,
                               std::optional<Distortion> kind = {}) {
  const std::vector<DetectedCapture> capture{test::capture_of_unknown_rig(room)};
  return grow_lens(captures_of_camera(capture, 0), kind, {});
}

TEST(LensGrowth, AStraightLensStaysStraight) {
  const auto room = test::noisy_room(1);
  const auto lens = grown(room);
  ASSERT_TRUE(lens);
  EXPECT_TRUE(lens->firm);
  EXPECT_EQ(lens->parameters.distortion, Distortion::none) << lens->evidence;
  EXPECT_NEAR(lens->parameters.fu_px, 640, 2);
  EXPECT_NEAR(lens->parameters.pu_px, 639.5, 2);
}

TEST(LensGrowth, ABentLensBends) {
  CameraParameters bent = test::ring_rig(1).cameras[0].model.parameters();
  bent.distortion = Distortion::radtan;
  bent.coefficients = {-0.1, 0.02, 0.0005, -0.0005};
  const auto lens = grown(test::taken_by(test::noisy_room(1), bent));
  ASSERT_TRUE(lens);
  EXPECT_EQ(lens->parameters.distortion, Distortion::radtan) << lens->evidence;
  EXPECT_NEAR(lens->parameters.fu_px, 640, 2);
  EXPECT_NEAR(lens->parameters.coefficients[0], -0.1, 0.01);
}

TEST(LensGrowth, AFisheyeIsOne) {
  CameraParameters fisheye = test::ring_rig(1).cameras[0].model.parameters();
  fisheye.distortion = Distortion::equidistant;
  fisheye.fu_px = fisheye.fv_px = 700;
  fisheye.coefficients = {-0.015, 0.003, 0.0, 0.0};
  const auto lens = grown(test::taken_by(test::noisy_room(1), fisheye));
  ASSERT_TRUE(lens);
  EXPECT_EQ(lens->parameters.distortion, Distortion::equidistant) << lens->evidence;
  EXPECT_NEAR(lens->parameters.fu_px, 700, 3);
}

TEST(LensGrowth, TakesTheKindAskedFor) {
  const auto lens = grown(test::noisy_room(1), Distortion::radtan);
  ASSERT_TRUE(lens);
  EXPECT_EQ(lens->parameters.distortion, Distortion::radtan);
  EXPECT_NEAR(lens->parameters.fu_px, 640, 2);
}

TEST(LensGrowth, OfImagesOfSingleMarkersIsNone) {
  auto room = test::noisy_room(1);
  for (ImageDetections& image : room.images) {
    if (!image.detections.empty()) image.detections.resize(1);
    for (Detection& detection : image.detections) detection.marker.number = 3;
  }
  const auto lens = grown(room);
  EXPECT_TRUE(!lens || !lens->firm);
}

}  // namespace
}  // namespace waymark
