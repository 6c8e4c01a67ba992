#include "mapbuilder/calibrate/calibrated_cameras.h"

#include "tests/mapbuilder/calibrate/unknown_room.h"

namespace waymark {
namespace {

TEST(CalibratedCameras, OfSeveralCapturesHaveTheRigOfTheLargest) {
  const auto three = test::capture_of_unknown_rig(test::noisy_room(3, 2));
  auto one = test::capture_of_unknown_rig(test::noisy_room(1, 2));
  const auto common = with_common_rig({one, three});
  ASSERT_TRUE(common);
  EXPECT_EQ((*common)[0].rig.cameras.size(), 3U);
  CameraParameters other = one.rig.cameras[0].model.parameters();
  other.width_px = 640;
  other.pu_px = 319.5;
  one.rig.cameras[0].model = *CameraModel::create(other);
  const auto refused = with_common_rig({one, three});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::bad_data);
}

TEST(CalibratedCameras, AloneHaveTheirImagesAsTheirOnlyCameras) {
  const auto capture = test::capture_of_unknown_rig(test::noisy_room(3, 4));
  const auto alone = captures_of_camera({capture}, 2);
  ASSERT_EQ(alone.size(), 1U);
  EXPECT_EQ(alone[0].rig.cameras.size(), 1U);
  EXPECT_EQ(alone[0].rig.cameras[0].name, "cam2");
  EXPECT_EQ(alone[0].images.size(), 4U);
  for (const ImageDetections& image : alone[0].images) EXPECT_EQ(image.camera, 0);
}

TEST(CalibratedCameras, ThatSeeNothingHaveNoCaptures) {
  auto capture = test::capture_of_unknown_rig(test::noisy_room(2, 4));
  for (ImageDetections& image : capture.images) {
    if (image.camera == 1) image.detections.clear();
  }
  EXPECT_TRUE(captures_of_camera({capture}, 1).empty());
}

TEST(CalibratedCameras, HaveHalvesOfWholeInstants) {
  const auto capture = test::capture_of_unknown_rig(test::noisy_room(3, 33));
  const auto halves = halves_of({capture});
  std::size_t images = 0;
  for (const auto& half : halves) {
    ASSERT_EQ(half.size(), 1U);
    EXPECT_EQ(half[0].images.size() % 3, 0U);
    EXPECT_GT(half[0].images.size(), 30U);
    images += half[0].images.size();
  }
  EXPECT_EQ(images, capture.images.size());
}

}  // namespace
}  // namespace waymark
