#include "drivers/v4l2/camera_controls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/drivers/v4l2/fake_video_system.h"

namespace waymark {
namespace {

using std::chrono::microseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

class CameraControlsTest : public testing::Test {
 protected:
  CameraControlsTest() {
    device_.controls = {{V4L2_CID_EXPOSURE_AUTO, {0, 3, 1, V4L2_EXPOSURE_APERTURE_PRIORITY}},
                        {V4L2_CID_EXPOSURE_ABSOLUTE, {1, 5000, 1, 100}},
                        {V4L2_CID_GAIN, {0, 255, 1, 16}}};
  }
  [[nodiscard]] Expected<AppliedControls> apply(const CameraControls& controls) {
    test::FakeVideoNode node(device_);
    return apply_controls(node, controls);
  }
  [[nodiscard]] std::string config_error(const CameraControls& controls) {
    const auto applied = apply(controls);
    if (applied) return "applied";
    EXPECT_EQ(applied.error().kind, ErrorKind::config);
    return applied.error().message;
  }

  test::FakeDevice device_;
};

TEST_F(CameraControlsTest, AutomaticsGoOffBeforeValuesAreSet) {
  device_.controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY] = {0, 1, 1, 1};
  device_.controls[V4L2_CID_AUTOGAIN] = {0, 1, 1, 1};
  const auto applied = apply({.exposure_us = 2000, .gain = 40});
  ASSERT_TRUE(applied) << applied.error().message;
  EXPECT_EQ(applied->exposure, microseconds(2000));
  EXPECT_EQ(applied->gain, 40);
  EXPECT_THAT(applied->notes, IsEmpty());
  EXPECT_THAT(device_.written, ElementsAre(Pair(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL),
                                           Pair(V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0),
                                           Pair(V4L2_CID_EXPOSURE_ABSOLUTE, 20),
                                           Pair(V4L2_CID_AUTOGAIN, 0), Pair(V4L2_CID_GAIN, 40)));
}

TEST_F(CameraControlsTest, WhereManualIsNotKnownShutterPriorityWillDo) {
  device_.controls[V4L2_CID_EXPOSURE_AUTO].refused = {V4L2_EXPOSURE_MANUAL};
  const auto applied = apply({.exposure_us = 2000});
  ASSERT_TRUE(applied) << applied.error().message;
  EXPECT_EQ(applied->exposure, microseconds(2000));
  EXPECT_EQ(device_.controls[V4L2_CID_EXPOSURE_AUTO].value, V4L2_EXPOSURE_SHUTTER_PRIORITY);
}

TEST_F(CameraControlsTest, AutomaticExposureThatStaysIsSaidAndItsLengthNotKnown) {
  device_.controls[V4L2_CID_EXPOSURE_AUTO].stuck = true;
  const auto applied = apply({.exposure_us = 2000});
  ASSERT_TRUE(applied) << applied.error().message;
  EXPECT_EQ(applied->exposure, Stamp{0});
  ASSERT_EQ(applied->notes.size(), 1U);
  EXPECT_THAT(applied->notes[0], HasSubstr("automatic exposure can't be switched off"));
}

TEST_F(CameraControlsTest, WithoutExposureNothingIsSetAndAnAutomaticOneIsSaid) {
  auto applied = apply({});
  ASSERT_TRUE(applied) << applied.error().message;
  EXPECT_EQ(applied->exposure, Stamp{0});
  EXPECT_THAT(applied->notes, ElementsAre(HasSubstr("set exposure_us")));
  EXPECT_THAT(device_.written, IsEmpty());
  device_.controls[V4L2_CID_EXPOSURE_AUTO].value = V4L2_EXPOSURE_MANUAL;
  applied = apply({});
  EXPECT_EQ(applied->exposure, microseconds(10'000));
  EXPECT_EQ(applied->gain, 16);
}

TEST_F(CameraControlsTest, ValuesGoToTheNextStepAndNotBeyondTheRange) {
  device_.controls[V4L2_CID_GAIN] = {10, 50, 10, 10};
  EXPECT_EQ(apply({.gain = 34})->gain, 30);
  EXPECT_EQ(apply({.gain = 54})->gain, 50);
  EXPECT_THAT(config_error({.gain = 56}), HasSubstr("takes 10 to 50 in steps of 10"));
  EXPECT_THAT(config_error({.exposure_us = 40}), HasSubstr("takes 100 to 500000"));
  EXPECT_EQ(apply({.exposure_us = 60})->exposure, microseconds(100));
}

TEST_F(CameraControlsTest, AValueThatTheDeviceDoesNotKeepIsRefused) {
  device_.controls[V4L2_CID_GAIN].stuck = true;
  EXPECT_THAT(config_error({.gain = 40}), HasSubstr("gain = 40 can't be set, the device has 16"));
}

TEST_F(CameraControlsTest, AControlThatIsNotThereIsRefused) {
  device_.controls.clear();
  EXPECT_THAT(config_error({.exposure_us = 2000}), HasSubstr("no such control"));
  EXPECT_THAT(config_error({.gain = 2}), HasSubstr("gain"));
  EXPECT_THAT(config_error({.white_balance_k = 4600}), HasSubstr("white_balance_k"));
  EXPECT_THAT(config_error({.focus = 3}), HasSubstr("focus"));
  EXPECT_THAT(config_error({.power_line_hz = 50}), HasSubstr("power_line_hz"));
  EXPECT_TRUE(apply({}));
}

TEST_F(CameraControlsTest, FocusIsNeverAutomatic) {
  device_.controls = {{V4L2_CID_FOCUS_AUTO, {0, 1, 1, 1}}};
  EXPECT_TRUE(apply({}));
  EXPECT_EQ(device_.controls[V4L2_CID_FOCUS_AUTO].value, 0);
  device_.controls[V4L2_CID_FOCUS_AUTO] = {0, 1, 1, 1, true};
  EXPECT_THAT(apply({})->notes, ElementsAre(HasSubstr("automatic focus")));
}

TEST_F(CameraControlsTest, WhiteBalanceFocusAndPowerLineAreSet) {
  device_.controls = {{V4L2_CID_AUTO_WHITE_BALANCE, {0, 1, 1, 1}},
                      {V4L2_CID_WHITE_BALANCE_TEMPERATURE, {2800, 6500, 1, 5000}},
                      {V4L2_CID_FOCUS_ABSOLUTE, {0, 100, 5, 0}},
                      {V4L2_CID_POWER_LINE_FREQUENCY, {0, 2, 1, 0}}};
  ASSERT_TRUE(apply({.white_balance_k = 4600, .focus = 30, .power_line_hz = 60}));
  EXPECT_EQ(device_.controls[V4L2_CID_AUTO_WHITE_BALANCE].value, 0);
  EXPECT_EQ(device_.controls[V4L2_CID_WHITE_BALANCE_TEMPERATURE].value, 4600);
  EXPECT_EQ(device_.controls[V4L2_CID_FOCUS_ABSOLUTE].value, 30);
  EXPECT_EQ(device_.controls[V4L2_CID_POWER_LINE_FREQUENCY].value,
            V4L2_CID_POWER_LINE_FREQUENCY_60HZ);
}

TEST_F(CameraControlsTest, ADeviceThatGoesMeanwhileIsNoWrongConfiguration) {
  device_.failures[VIDIOC_S_CTRL] = ENODEV;
  const auto gone = apply({.exposure_us = 2000});
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().kind, ErrorKind::unavailable);
  device_.failures[VIDIOC_S_CTRL] = EIO;
  EXPECT_EQ(apply({.gain = 2}).error().kind, ErrorKind::io);
}

TEST_F(CameraControlsTest, AFailedQuestionIsNoAbsentControl) {
  for (const auto& [failure, kind] : {std::pair(EIO, ErrorKind::io),
                                      {ETIMEDOUT, ErrorKind::io},
                                      {ENODEV, ErrorKind::unavailable}}) {
    device_.controls[V4L2_CID_EXPOSURE_AUTO].failure = failure;
    for (const CameraControls& controls : {CameraControls{.exposure_us = 2000}, {}}) {
      const auto applied = apply(controls);
      ASSERT_FALSE(applied) << failure;
      EXPECT_EQ(applied.error().kind, kind) << applied.error().message;
    }
    device_.controls[V4L2_CID_EXPOSURE_AUTO].failure = 0;
    device_.controls[V4L2_CID_GAIN].failure = failure;
    EXPECT_EQ(apply({.gain = 40}).error().kind, kind);
    EXPECT_EQ(apply({})->gain, std::nullopt);  // nobody asked for it
    device_.controls[V4L2_CID_GAIN].failure = 0;
  }
  device_.controls[V4L2_CID_FOCUS_AUTO] = {.high = 1, .value = 1, .failure = EIO};
  EXPECT_EQ(apply({}).error().kind, ErrorKind::io) << "automatic focus would stay on unseen";
  for (const int absent : {EINVAL, ENOTTY}) {
    device_.controls[V4L2_CID_FOCUS_AUTO].failure = absent;
    EXPECT_TRUE(apply({}));
  }
}

TEST_F(CameraControlsTest, WhatAnotherLibraryHasSetIsReadBackAndNothingIsWritten) {
  const auto read = [&](const CameraControls& wanted) {
    test::FakeVideoNode node(device_);
    return read_controls(node, wanted);
  };
  auto found = read({.exposure_us = 3000});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->exposure, Stamp{0});
  EXPECT_THAT(found->notes, ElementsAre(HasSubstr("automatic exposure can't be switched off")));
  device_.controls[V4L2_CID_EXPOSURE_AUTO].value = V4L2_EXPOSURE_MANUAL;
  found = read({.exposure_us = 3000});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::io) << "the other library may have met a loose cable";
  EXPECT_THAT(found.error().message,
              HasSubstr("exposure_us = 3000 was not set, the device has 10"));
  device_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 30;
  found = read({.exposure_us = 3040});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->exposure, microseconds(3000));
  EXPECT_EQ(found->gain, 16);
  EXPECT_FALSE(read({.exposure_us = 3101}));
  device_.controls.clear();
  found = read({.exposure_us = 3000});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->exposure, Stamp{0});
  device_.gone = true;
  EXPECT_EQ(read({}).error().kind, ErrorKind::unavailable);
  EXPECT_THAT(device_.written, IsEmpty());
}

}  // namespace
}  // namespace waymark
