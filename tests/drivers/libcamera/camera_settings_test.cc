#include "drivers/libcamera/camera_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <libcamera/control_ids.h>
#include <libcamera/property_ids.h>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

namespace controls = libcamera::controls;

/// Of a USB camera as libcamera 0.0.3 presents it: exposure, gain, nothing else.
libcamera::ControlInfoMap exposure_and_gain() {
  return {
      {{&controls::ExposureTime, libcamera::ControlInfo(std::int32_t{100}, std::int32_t{10000})},
       {&controls::AnalogueGain, libcamera::ControlInfo(1.0F, 8.0F)},
       {&controls::AeEnable, libcamera::ControlInfo(false, true)}},
      controls::controls};
}

CameraOptions camera_named_left() {
  CameraOptions options;
  options.name = "left";
  return options;
}

void expect_refused(const CameraOptions& options, const std::string& because) {
  const auto set = start_controls(exposure_and_gain(), options);
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().kind, ErrorKind::config);
  EXPECT_THAT(set.error().message, HasSubstr(because));
}

TEST(LibcameraControls, WhatTheCameraHasIsSetAndItsAutomatismsAreOff) {
  CameraOptions options = camera_named_left();
  options.controls.exposure_us = 3000;
  options.controls.gain = 2;
  const auto set = start_controls(exposure_and_gain(), options);
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(set->get(controls::ExposureTime), 3000);
  EXPECT_EQ(set->get(controls::AnalogueGain), 2.0F);
  EXPECT_EQ(set->get(controls::AeEnable), false);
}

TEST(LibcameraControls, WhatTheCameraDoesNotHaveIsRefusedByName) {
  CameraOptions options = camera_named_left();
  options.request.fps = 30;
  expect_refused(options, "left: fps = 30: libcamera has no such control of this camera");
  options = camera_named_left();
  options.controls.white_balance_k = 4600;
  expect_refused(options, "left: white_balance_k = 4600: libcamera has no such control");
  options = camera_named_left();
  options.controls.power_line_hz = 50;
  expect_refused(options, "left: power_line_hz = 50: libcamera has no such control");
  options = camera_named_left();
  options.controls.focus = 1;
  expect_refused(options, "left: focus = 1: libcamera has no such control");
}

TEST(LibcameraControls, AValueOutsideTheCamerasRangeIsRefused) {
  CameraOptions options = camera_named_left();
  options.controls.exposure_us = 10000;
  EXPECT_TRUE(start_controls(exposure_and_gain(), options));
  options.controls.exposure_us = 10001;
  expect_refused(options, "left: exposure_us = 10001 can't be set; the camera takes 100 to 10000");
  options.controls.exposure_us = 99;
  expect_refused(options, "left: exposure_us = 99 can't be set");
}

TEST(LibcameraMetadata, ExposureIsKnownWhenToldAndNeverAssumed) {
  libcamera::ControlList metadata(controls::controls);
  EXPECT_EQ(exposure_of(metadata, Stamp{0}), Stamp{0});
  EXPECT_EQ(exposure_of(metadata, milliseconds(3)), milliseconds(3));
  metadata.set(controls::ExposureTime, 2000);
  EXPECT_EQ(exposure_of(metadata, milliseconds(3)), milliseconds(2));
}

TEST(LibcameraMetadata, AStampThatIsNotTheSensorsMeansNothingKnown) {
  libcamera::ControlList metadata(controls::controls);
  EXPECT_EQ(stamp_meaning(metadata), StampMeaning::unknown);
  metadata.set(controls::SensorTimestamp, std::int64_t{1});
  EXPECT_EQ(stamp_meaning(metadata), StampMeaning::start_of_exposure);
}

TEST(LibcameraMetadata, ACropIsRefusedWhereTheCameraTellsOfOne) {
  const libcamera::Rectangle whole(0, 0, 1640, 1232);
  libcamera::ControlList metadata(controls::controls);
  libcamera::ControlList properties(libcamera::properties::properties);
  EXPECT_TRUE(check_crop("left", metadata, properties));
  metadata.set(controls::ScalerCrop, libcamera::Rectangle(0, 0, 1640, 1231));
  EXPECT_TRUE(check_crop("left", metadata, properties));
  properties.set(libcamera::properties::ScalerCropMaximum, whole);
  const Status cropped = check_crop("left", metadata, properties);
  ASSERT_FALSE(cropped);
  EXPECT_EQ(cropped.error().kind, ErrorKind::config);
  EXPECT_THAT(cropped.error().message, HasSubstr("left: crops (0, 0)/1640x1231"));
  metadata.set(controls::ScalerCrop, whole);
  EXPECT_TRUE(check_crop("left", metadata, properties));
}

}  // namespace
}  // namespace waymark
