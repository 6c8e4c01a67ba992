#include "mapbuilder/import/ros_rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/recordings.h"

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

RosCameraInfo info(double focal_px, std::uint32_t binning = 0) {
  const std::string message = test::camera_info("/a", 640, 480, focal_px, binning).data;
  return parse_ros_camera_info({reinterpret_cast<const std::uint8_t*>(message.data()),  // NOLINT
                                message.size()})
      .value();
}

TEST(RosRig, HasALensForEachCamera) {
  RosCameraInfo bent = info(400);
  bent.distortion = {0.1, -0.05, 0.001, 0.002, 0};
  const auto loaded =
      rig_of_lenses({{"/l/camera_info", info(500.25), false}, {"/r/camera_info", bent, false}});
  ASSERT_TRUE(loaded) << loaded.error().message;
  const Rig& rig = loaded->rig;
  ASSERT_EQ(rig.cameras.size(), 2U);
  EXPECT_FALSE(rig.has_extrinsics);
  EXPECT_EQ(rig.cameras[0].model.parameters().fu_px, 500.25);
  EXPECT_EQ(rig.cameras[0].model.parameters().pv_px, 239.5);
  EXPECT_EQ(rig.cameras[1].model.parameters().distortion, Distortion::radtan);
  EXPECT_EQ(rig.cameras[1].model.parameters().coefficients[1], -0.05);
}

TEST(RosRig, RectifiedImagesHaveTheProjectionMatrix) {
  RosCameraInfo bent = info(400);
  bent.distortion = {0.1, -0.05, 0.001, 0.002, 0};
  const auto loaded = rig_of_lenses({{"/l/camera_info", bent, true}});
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->rig.cameras[0].model.parameters().fu_px, 800);
  EXPECT_EQ(loaded->rig.cameras[0].model.parameters().distortion, Distortion::none);
  EXPECT_TRUE(is_rectified_topic("/l/image_rect_color"));
  EXPECT_TRUE(is_rectified_topic("/l/image_rect/compressed"));
  EXPECT_FALSE(is_rectified_topic("/image_rect/image_raw"));
}

TEST(RosRig, WhatSaysNothingIsTold) {
  EXPECT_THAT(rig_of_lenses({{"/l/camera_info", info(0), false}}).error().message,
              HasSubstr("not calibrated"));
  EXPECT_THAT(rig_of_lenses({{"/l/camera_info", info(400, 2), false}}).error().message,
              HasSubstr("binned"));
  RosCameraInfo strange = info(400);
  strange.distortion_model = "thin_prism";
  EXPECT_THAT(rig_of_lenses({{"/l/camera_info", strange, false}}).error().message,
              HasSubstr("/l/camera_info"));
  strange = info(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(rig_of_lenses({{"/l/camera_info", strange, false}}));
}

TEST(RosRig, CameraInfoLiesBesideItsImages) {
  EXPECT_THAT(camera_info_topics("/l/image_raw"),
              ElementsAre("/l/camera_info", "/l/image_raw/camera_info"));
  EXPECT_THAT(camera_info_topics("/l/image_raw/compressed"),
              ElementsAre("/l/camera_info", "/l/image_raw/camera_info"));
  EXPECT_THAT(camera_info_topics("image"), ElementsAre("camera_info", "image/camera_info"));
}

}  // namespace
}  // namespace waymark
