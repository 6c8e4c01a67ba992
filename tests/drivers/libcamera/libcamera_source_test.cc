#include "drivers/libcamera/libcamera_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "drivers/libcamera/stamp_clock.h"
#include "drivers/monotonic_clock.h"
#include "tests/drivers/v4l2/fake_video_system.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

TEST(LibcameraId, IsWhatDoesNotLookLikeADeviceOfVideo4Linux) {
  EXPECT_TRUE(is_libcamera_id("/base/soc/i2c0mux/i2c@1/imx219@10"));
  EXPECT_TRUE(is_libcamera_id("\\_SB_.PCI0.S10_-1:1.0-1209:0c01"));
  EXPECT_FALSE(is_libcamera_id("/dev/v4l/by-id/left"));
  EXPECT_FALSE(is_libcamera_id("serial=4711"));
  EXPECT_FALSE(is_libcamera_id("bus=usb-1"));
}

TEST(StampClock, StampsBeyondNowAreOfTheClockThatIsAhead) {
  const Stamp now = seconds(1000);
  const Stamp boottime = now + seconds(60);  // it slept for a minute
  const Stamp age = milliseconds(30);
  EXPECT_EQ(to_monotonic(now - age, now, boottime), now - age);
  EXPECT_EQ(to_monotonic(boottime - age, now, boottime), now - age);
  EXPECT_EQ(to_monotonic(now + milliseconds(2), now, boottime), now + milliseconds(2));
  EXPECT_EQ(to_monotonic(now - age, now, now), now - age);
}

#ifdef WAYMARK_LIBCAMERA
/// The module, on a machine whose libcamera sees none of the cameras asked for.
Error start_error(const LibcameraOptions& options) {
  const auto system = std::make_shared<test::FakeVideoSystem>();
  const auto source = libcamera_source(system, options);
  if (!source) return source.error();
  EXPECT_EQ((*source)->name(), "cam0");
  EXPECT_FALSE((*source)->inspect());
  const Status started = (*source)->start();
  EXPECT_FALSE((*source)->next(Stamp{0}));
  return started ? Error{ErrorKind::internal, "started"} : started.error();
}

LibcameraOptions options_of_cam0() {
  LibcameraOptions options;
  options.camera.name = "cam0";
  options.camera.request = {64, 48, nullptr, 0};
  return options;
}

TEST(LibcameraSource, ACameraThatIsNotThereIsNamed) {
  LibcameraOptions options = options_of_cam0();
  options.id = "/base/soc/no/such/camera";
  const Error by_id = start_error(options);
  EXPECT_EQ(by_id.kind, ErrorKind::unavailable) << by_id.message;
  EXPECT_THAT(by_id.message, HasSubstr("/base/soc/no/such/camera: libcamera has no such camera"));
  EXPECT_THAT(by_id.message, HasSubstr("`cam --list` shows what hinders it"));
  options = options_of_cam0();
  options.camera.device.serial = "0815";
  EXPECT_THAT(start_error(options).message, HasSubstr("serial=0815: no such camera is plugged in"));
}

/// libcamera watches devices in threads of its own for as long as somebody holds its manager.
TEST(LibcameraSource, OneThatFindsNoCameraLetsLibcameraLookAnew) {
  const auto threads = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
  };
  LibcameraOptions options = options_of_cam0();
  options.id = "imx219";
  const auto source = libcamera_source(std::make_shared<test::FakeVideoSystem>(), options);
  ASSERT_TRUE(source);
  const auto before = threads();  // with those of the libraries that are loaded by now
  for (int attempt = 0; attempt < 3; ++attempt) {
    EXPECT_THAT((*source)->start().error().message, HasSubstr("no such camera"));
    // A thread that was joined stays in the list for a moment.
    const Stamp deadline = monotonic_now() + seconds(20);
    while (threads() > before && monotonic_now() < deadline) std::this_thread::yield();
    EXPECT_LE(threads(), before);
  }
}

TEST(LibcameraSource, WhatLibcameraSaysByItselfStaysOutOfTheLog) {
  LibcameraOptions options = options_of_cam0();
  options.id = "imx219";
  ::testing::internal::CaptureStderr();
  const Error absent = start_error(options);
  const std::string written = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(absent.kind, ErrorKind::unavailable);
  EXPECT_EQ(written, "");
}

TEST(LibcameraSource, AnotherSerialNumberThanTheRigsIsRefused) {
  LibcameraOptions options = options_of_cam0();
  options.camera.device.bus = "usb-1";
  options.camera.serial = "0815";
  EXPECT_EQ(start_error(options).kind, ErrorKind::config);
  options = options_of_cam0();
  options.id = "imx219";
  options.camera.serial = "0815";
  const Error unknown = start_error(options);
  EXPECT_EQ(unknown.kind, ErrorKind::config);
  EXPECT_THAT(unknown.message, HasSubstr("device = \"serial=0815\""));
}
#endif

}  // namespace
}  // namespace waymark
