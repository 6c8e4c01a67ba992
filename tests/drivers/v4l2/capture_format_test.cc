#include "drivers/v4l2/capture_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/drivers/v4l2/fake_video_system.h"

namespace waymark {
namespace {

using testing::HasSubstr;

class CaptureFormatTest : public testing::Test {
 protected:
  CaptureFormatTest() {
    device_.formats = {{V4L2_PIX_FMT_YUYV, {{64, 48}}},
                       {V4L2_PIX_FMT_GREY, {{1224, 1024}, {64, 48}}},
                       {V4L2_PIX_FMT_RGB24, {{64, 48}}}};
  }
  [[nodiscard]] Expected<CaptureFormat> set(const CaptureRequest& request) {
    test::FakeVideoNode node(device_);
    return set_capture_format(node, request);
  }
  [[nodiscard]] std::string config_error(const CaptureRequest& request) {
    const auto format = set(request);
    if (format) return "set";
    EXPECT_EQ(format.error().kind, ErrorKind::config);
    return format.error().message;
  }

  test::FakeDevice device_;
};

TEST_F(CaptureFormatTest, TheBestThatIsOfferedIsTaken) {
  const auto format = set({64, 48, nullptr, 30});
  ASSERT_TRUE(format) << format.error().message;
  EXPECT_EQ(format->layout.pixels->name, "GREY");
  EXPECT_EQ(format->layout.stride_bytes, 64U);
  EXPECT_EQ(format->layout.least_bytes(), 64U * 48);
  EXPECT_DOUBLE_EQ(format->fps, 30);
}

TEST_F(CaptureFormatTest, TheBestIsThatWhichComesInTheWantedSize) {
  device_.formats = {{V4L2_PIX_FMT_GREY, {{32, 24}}}, {V4L2_PIX_FMT_MJPEG, {{32, 24}, {64, 48}}}};
  const auto format = set({64, 48, nullptr, 30});
  ASSERT_TRUE(format) << format.error().message;
  EXPECT_EQ(format->layout.pixels->name, "MJPG");
}

TEST_F(CaptureFormatTest, TheLastRowNeedsNoPadding) {
  device_.stride_bytes = 160;
  const auto format = set({64, 48, find_pixel_format("YUYV"), 0});
  ASSERT_TRUE(format) << format.error().message;
  EXPECT_EQ(format->layout.least_bytes(), 160U * 47 + 128);
}

TEST_F(CaptureFormatTest, AnotherResolutionIsRefusedAndNamesWhatThereIs) {
  const std::string message = config_error({640, 480, nullptr, 0});
  EXPECT_THAT(message, HasSubstr("640×480"));
  EXPECT_THAT(message, HasSubstr("gives GREY 1224×1024"));
  EXPECT_THAT(message, HasSubstr("GREY 1224×1024, 64×48"));
}

TEST_F(CaptureFormatTest, AFormatThatIsNotOfferedIsRefused) {
  EXPECT_THAT(config_error({64, 48, find_pixel_format("MJPG"), 0}),
              HasSubstr("does not deliver MJPG; it offers"));
  device_.formats = {{V4L2_PIX_FMT_RGB24, {{64, 48}}}};
  EXPECT_THAT(config_error({64, 48, nullptr, 0}), HasSubstr("offers RGB3 64×48"));
}

TEST_F(CaptureFormatTest, ACropIsRefusedWithTheCommandThatEndsIt) {
  device_.has_crop = true;
  EXPECT_TRUE(set({64, 48, nullptr, 0}));
  device_.crop = {2, 0, 62, 48};
  EXPECT_THAT(config_error({64, 48, nullptr, 0}),
              HasSubstr("--set-selection=target=crop,left=0,top=0,width=64,height=48"));
}

TEST_F(CaptureFormatTest, TheFrameRateIsReadBack) {
  EXPECT_DOUBLE_EQ(set({64, 48, nullptr, 12.5})->fps, 12.5);
  device_.fps = 25;
  device_.fps_is_fixed = true;
  EXPECT_TRUE(set({64, 48, nullptr, 25.2}));
  EXPECT_THAT(config_error({64, 48, nullptr, 25.3}), HasSubstr("the device does 25; it can 25"));
  EXPECT_DOUBLE_EQ(set({64, 48, nullptr, 0})->fps, 25);
  device_.fps = 0;
  EXPECT_TRUE(set({64, 48, nullptr, 0}));
  EXPECT_THAT(config_error({64, 48, nullptr, 30}), HasSubstr("fps = 30 can't be set"));
}

TEST_F(CaptureFormatTest, ARowThatIsTooShortIsTheDriversError) {
  device_.stride_bytes = 63;
  const auto format = set({64, 48, nullptr, 0});
  ASSERT_FALSE(format);
  EXPECT_EQ(format.error().kind, ErrorKind::io);
}

TEST_F(CaptureFormatTest, AGoneDeviceIsUnavailable) {
  device_.gone = true;
  const auto format = set({64, 48, nullptr, 0});
  ASSERT_FALSE(format);
  EXPECT_EQ(format.error().kind, ErrorKind::unavailable);
}

TEST_F(CaptureFormatTest, AFailedQuestionIsNoWrongConfiguration) {
  for (const unsigned long question :
       {VIDIOC_ENUM_FMT, VIDIOC_G_PARM, VIDIOC_G_SELECTION, VIDIOC_S_PARM}) {
    for (const int failure : {EIO, ETIMEDOUT, ENODEV}) {
      device_.failures = {{question, failure}};
      const auto format = set({64, 48, nullptr, 30});
      ASSERT_FALSE(format) << question;
      EXPECT_EQ(format.error().kind, failure == ENODEV ? ErrorKind::unavailable : ErrorKind::io)
          << format.error().message;
    }
  }
}

TEST_F(CaptureFormatTest, ADeviceMayHaveNoListNoRateAndNoCrop) {
  for (const int absent : {EINVAL, ENOTTY, ENODATA}) {
    device_.failures = {
        {VIDIOC_ENUM_FMT, absent}, {VIDIOC_G_PARM, absent}, {VIDIOC_G_SELECTION, absent}};
    EXPECT_TRUE(set({64, 48, find_pixel_format("GREY"), 0}));
    const auto unknown_rate = set({64, 48, find_pixel_format("GREY"), 30});
    ASSERT_FALSE(unknown_rate);
    EXPECT_EQ(unknown_rate.error().kind, ErrorKind::config);
  }
}

TEST_F(CaptureFormatTest, WhatIsUnderstoodIsListedTheBestFirst) {
  test::FakeVideoNode node(device_);
  const auto formats = understood_formats(node);
  ASSERT_EQ(formats.size(), 3U);
  EXPECT_EQ(formats[0].pixels->name, "GREY");
  EXPECT_EQ(formats[0].width_px, 1224);
  EXPECT_EQ(formats[2].pixels->name, "YUYV");
}

}  // namespace
}  // namespace waymark
