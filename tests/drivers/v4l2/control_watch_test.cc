#include "drivers/v4l2/control_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/v4l2/camera_controls.h"
#include "tests/drivers/v4l2/fake_video_system.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;
using testing::IsEmpty;

class ControlWatchTest : public testing::Test {
 protected:
  ControlWatchTest() {
    device_.controls = {{V4L2_CID_EXPOSURE_AUTO, {0, 3, 1, V4L2_EXPOSURE_APERTURE_PRIORITY}},
                        {V4L2_CID_EXPOSURE_ABSOLUTE, {1, 5000, 1, 100}},
                        {V4L2_CID_AUTOGAIN, {0, 1, 1, 1}},
                        {V4L2_CID_GAIN, {0, 255, 1, 16}},
                        {V4L2_CID_FOCUS_AUTO, {0, 1, 1, 1}},
                        {V4L2_CID_FOCUS_ABSOLUTE, {0, 100, 5, 0}},
                        {V4L2_CID_AUTO_WHITE_BALANCE, {0, 1, 1, 1}},
                        {V4L2_CID_WHITE_BALANCE_TEMPERATURE, {2800, 6500, 1, 5000}},
                        {V4L2_CID_POWER_LINE_FREQUENCY, {0, 2, 1, 0}}};
  }
  void begin(const CameraControls& controls) {
    const auto applied = apply_controls(node_, controls);
    ASSERT_TRUE(applied) << applied.error().message;
    watch_.begin(applied->held, now_);
  }
  [[nodiscard]] std::string look_after(Stamp time) {
    now_ += time;
    watch_.look(node_, now_);
    return watch_.changed();
  }

  test::FakeDevice device_;
  test::FakeVideoNode node_{device_};
  ControlWatch watch_;
  Stamp now_{seconds(100)};
};

constexpr CameraControls kAll{
    .exposure_us = 2000, .gain = 40, .white_balance_k = 4600, .focus = 30, .power_line_hz = 60};

TEST_F(ControlWatchTest, EveryControlThatWasSetIsHeld) {
  begin(kAll);
  EXPECT_THAT(look_after(seconds(1)), IsEmpty());
  for (auto& [id, control] : device_.controls) {
    const int ours = control.value;
    control.value = ours == control.low ? control.high : control.low;
    EXPECT_THAT(look_after(seconds(1)), HasSubstr("by another program")) << id;
    EXPECT_EQ(control.value, ours) << id;
    EXPECT_THAT(look_after(seconds(1)), IsEmpty()) << id;
  }
}

TEST_F(ControlWatchTest, LooksOnceASecond) {
  begin(kAll);
  device_.controls[V4L2_CID_GAIN].value = 200;
  EXPECT_THAT(look_after(milliseconds(999)), IsEmpty());
  EXPECT_THAT(look_after(milliseconds(1)), HasSubstr("gain was set from 40 to 200"));
  device_.written.clear();
  EXPECT_THAT(look_after(milliseconds(999)), HasSubstr("gain")) << "until a look finds it mended";
  EXPECT_THAT(device_.written, IsEmpty());
}

TEST_F(ControlWatchTest, WhatIsAutomaticOrWasLeftAloneMayChange) {
  device_.controls[V4L2_CID_EXPOSURE_AUTO].stuck = true;
  begin({});
  device_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 7;
  device_.controls[V4L2_CID_GAIN].value = 7;
  device_.controls[V4L2_CID_WHITE_BALANCE_TEMPERATURE].value = 3000;
  EXPECT_THAT(look_after(seconds(1)), IsEmpty());
}

TEST_F(ControlWatchTest, AnExposureThatWasFoundFixedIsHeldForStampsRestOnIt) {
  device_.controls[V4L2_CID_EXPOSURE_AUTO].value = V4L2_EXPOSURE_MANUAL;
  begin({});
  device_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 7;
  EXPECT_THAT(look_after(seconds(1)), HasSubstr("exposure was set from 100 to 7"));
  device_.controls[V4L2_CID_EXPOSURE_AUTO].value = V4L2_EXPOSURE_APERTURE_PRIORITY;
  EXPECT_THAT(look_after(seconds(1)), HasSubstr("automatic exposure was set from 1 to 3"));
}

TEST_F(ControlWatchTest, ADeviceThatCannotBeAskedTellsNothing) {
  begin(kAll);
  device_.controls[V4L2_CID_GAIN].value = 200;
  for (const int failure : {EIO, ETIMEDOUT, ENODEV, EACCES}) {
    device_.failures[VIDIOC_G_CTRL] = failure;
    EXPECT_THAT(look_after(seconds(1)), IsEmpty());
  }
}

TEST_F(ControlWatchTest, WhoeverSetsItAgainAndAgainIsToldUntilTheEnd) {
  begin(kAll);
  for (int i = 0; i < 5; ++i) {
    device_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 300;
    EXPECT_THAT(look_after(seconds(1)), HasSubstr("from 20 to 300"));
  }
  EXPECT_THAT(look_after(seconds(1)), IsEmpty());
}

}  // namespace
}  // namespace waymark
