#include "mapbuilder/calibrate/found_rig.h"

#include "tests/mapbuilder/calibrate/unknown_room.h"

namespace waymark {
namespace {

Expected<FoundRig> found(const std::vector<DetectedCapture>& captures) {
  Progress progress(false);
  return find_rig(captures, {}, progress);
}

TEST(FoundRig, HasLensesAndPlacesNearTheTrueOnesWithoutAnyCommonView) {
  const auto room = test::noisy_room(3);
  const auto rig = found({test::capture_of_unknown_rig(room)});
  ASSERT_TRUE(rig) << rig.error().message;
  ASSERT_TRUE(rig->rig.has_extrinsics);
  const Rigid3 first_from_rig = room.rig.cameras[0].rig_from_cam.inverse();
  for (std::size_t k = 0; k < 3; ++k) {
    const Rigid3 truth = first_from_rig * room.rig.cameras[k].rig_from_cam;
    const Rigid3& place = rig->rig.cameras[k].rig_from_cam;
    EXPECT_LT((place.translation - truth.translation).norm(), 0.01) << k;
    EXPECT_LT(angle_between_rad(place.rotation, truth.rotation), 0.005) << k;
    EXPECT_NEAR(rig->rig.cameras[k].model.parameters().fu_px, 640, 3) << k;
  }
  EXPECT_TRUE(rig->findings.empty());
}

TEST(FoundRig, SaysWhichCameraNothingLinks) {
  auto room = test::noisy_room(2);
  // cam1 is never on when cam0 is.
  std::erase_if(room.images, [](const ImageDetections& image) {
    const auto number = (image.stamp - test::room_stamp(0)) / std::chrono::milliseconds(100);
    return number % 2 != image.camera;
  });
  const auto rig = found({test::capture_of_unknown_rig(room)});
  ASSERT_TRUE(rig) << rig.error().message;
  EXPECT_FALSE(rig->rig.has_extrinsics);
  ASSERT_EQ(rig->findings.size(), 1U);
  EXPECT_EQ(rig->findings[0].subject, "cam1");
}

TEST(FoundRig, OfABlindCameraIsAnError) {
  auto room = test::noisy_room(2, 20);
  for (ImageDetections& image : room.images) {
    if (image.camera == 1) image.detections.clear();
  }
  const auto rig = found({test::capture_of_unknown_rig(room)});
  ASSERT_FALSE(rig);
  EXPECT_EQ(rig.error().kind, ErrorKind::bad_data);
  EXPECT_EQ(rig.error().message.rfind("cam1", 0), 0U);
  EXPECT_EQ(found({}).error().kind, ErrorKind::usage);
}

}  // namespace
}  // namespace waymark
