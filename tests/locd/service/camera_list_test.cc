#include "locd/service/camera_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "locd/service/config.h"
#include "tests/drivers/v4l2/fake_video_system.h"

namespace waymark {
namespace {

using testing::HasSubstr;

TEST(ListCameras, PrintsBlocksThatTheConfigurationTakes) {
  test::FakeVideoSystem system;
  system.cameras.push_back({});
  system.cameras[0].identity = {"/dev/video0", {}, "usb-1", "left", "Grey"};
  system.cameras[1].identity = {"/dev/video2", {}, "usb-2", "right", "Grey"};
  system.cameras[1].formats = {{V4L2_PIX_FMT_YUYV, {{64, 48}}}};
  std::ostringstream out;
  ASSERT_TRUE(list_cameras(system, {}, out));
  const auto config = parse_config("[rig]\ncamchain = \"rig.yaml\"\n" + out.str(), "locd.toml");
  ASSERT_TRUE(config) << config.error().message;
  ASSERT_EQ(config->cameras.size(), 2U);
  EXPECT_EQ(config->cameras[0].device, "serial=left");
  EXPECT_EQ(config->cameras[0].format, "GREY");
  EXPECT_EQ(config->cameras[1].name, "cam1");
  EXPECT_EQ(config->cameras[1].device, "serial=right");
  EXPECT_EQ(config->cameras[1].format, "YUYV");
}

TEST(ListCameras, SuggestsTheFormatOfTheLargestImageAndNoBlockWithoutOne) {
  test::FakeVideoSystem system;
  system.cameras.resize(3);
  system.cameras[0].identity = {"/dev/video0", {}, "usb-1", "colour", "RGB"};
  system.cameras[0].formats = {{V4L2_PIX_FMT_RGB24, {{64, 48}}}};
  system.cameras[1].identity = {"/dev/video2", {}, "usb-2", "large", "Web"};
  system.cameras[1].formats = {{V4L2_PIX_FMT_GREY, {{64, 48}}},
                               {V4L2_PIX_FMT_MJPEG, {{64, 48}, {1920, 1080}}}};
  system.cameras[2].identity = {"/dev/video4", {}, "usb-3", "unlisted", "Loop"};
  system.cameras[2].formats = {{V4L2_PIX_FMT_GREY, {}}};
  std::ostringstream out;
  ASSERT_TRUE(list_cameras(system, {}, out));
  EXPECT_THAT(out.str(), HasSubstr("# offers RGB3 64×48\n# none of which is understood"));
  const auto config = parse_config("[rig]\ncamchain = \"rig.yaml\"\n" + out.str(), "locd.toml");
  ASSERT_TRUE(config) << config.error().message << out.str();
  ASSERT_EQ(config->cameras.size(), 2U);
  EXPECT_EQ(config->cameras[0].name, "cam0");
  EXPECT_EQ(config->cameras[0].device, "serial=large");
  EXPECT_EQ(config->cameras[0].format, "MJPG");
  EXPECT_EQ(config->cameras[1].name, "cam1");
  EXPECT_EQ(config->cameras[1].format, "GREY");
}

TEST(ListCameras, AnImageOfTheMostPixelsThatUsbCanStateIsTheLargest) {
  test::FakeVideoSystem system;
  system.cameras[0].formats = {{V4L2_PIX_FMT_GREY, {{64, 48}}},
                               {V4L2_PIX_FMT_YUYV, {{65535, 65535}}}};
  std::ostringstream out;
  ASSERT_TRUE(list_cameras(system, {}, out));
  EXPECT_THAT(out.str(), HasSubstr("format = \"YUYV\"  # 65535×65535"));
}

TEST(ListCameras, LibcamerasAreListedWhereV4l2HasNoBlock) {
  test::FakeVideoSystem system;
  system.cameras.push_back({});
  system.cameras[0].identity = {"/dev/video0", {}, "usb-1", "left", "Grey"};
  system.cameras[1].identity = {"/dev/video2", {}, "platform:unicam", "", "raw"};
  system.cameras[1].formats = {{V4L2_PIX_FMT_SRGGB10, {{64, 48}}}};
  const std::vector<OfferedFormat> understood{{find_pixel_format("NV12"), 1640, 1232}};
  const std::vector<LibcameraCamera> by_libcamera{
      {"\\_SB_.PCI0-1:1.0", "Grey", "GREY", understood, {"/dev/video0"}},
      {"\\_SB_.I2C1.imx219", "imx219", "NV12 1640×1232", understood, {"/dev/video2"}},
      {"/base/raw", "raw", "SRGGB10", {}, {}}};
  std::ostringstream out;
  ASSERT_TRUE(list_cameras(system, by_libcamera, out));
  const auto config = parse_config("[rig]\ncamchain = \"rig.yaml\"\n" + out.str(), "locd.toml");
  ASSERT_TRUE(config) << config.error().message << out.str();
  ASSERT_EQ(config->cameras.size(), 2U) << out.str();
  EXPECT_EQ(config->cameras[1].driver, CameraDriver::libcamera);
  EXPECT_EQ(config->cameras[1].device, "\\_SB_.I2C1.imx219");
  EXPECT_EQ(config->cameras[1].format, "NV12");
  EXPECT_THAT(out.str(), HasSubstr("# /base/raw (raw), by libcamera\n# offers SRGGB10\n# none"));
  system.cameras.clear();
  EXPECT_TRUE(list_cameras(system, by_libcamera, out));
}

TEST(ListCameras, SaysOfThoseThatCantBeToldApart) {
  test::FakeVideoSystem system;
  system.cameras.push_back({});
  std::ostringstream out;
  ASSERT_TRUE(list_cameras(system, {}, out));
  EXPECT_THAT(out.str(), HasSubstr("# can't be told from another camera"));
  EXPECT_EQ(out.str().find("[[camera]]"), std::string::npos);
}

TEST(ListCameras, ADeviceThatLiesAboutItsNameWritesNothingIntoTheConfiguration) {
  const std::string hostile =
      "X'\n[lcm]\nurl = \"udpm://239.1.1.1:7667?ttl=255\"\n[record]\ndir = \"/tmp\"\n#\x1b[2J";
  test::FakeVideoSystem system;
  system.cameras.resize(2);
  system.cameras[0].identity = {"/dev/video0", {"/dev/v4l/by-id/" + hostile}, "usb-1", hostile, ""};
  system.cameras[0].identity.card = "\n[lcm]\nurl = \"u\"\n#";
  // No way to name it is left.
  system.cameras[1].identity = {"/dev/video2", {}, "platform:\n[lcm]", "", "\x1b]0;x\x07"};
  system.cameras[1].formats = {{v4l2_fourcc('\n', '[', 'x', ']'), {{64, 48}}}};
  const std::vector<OfferedFormat> understood{{find_pixel_format("NV12"), 1640, 1232}};
  const std::vector<LibcameraCamera> by_libcamera{
      {"id'\n[lcm]\nurl=\"u\"\n#", "model\n[lcm]", "NV12\n[lcm]", understood, {}}};
  std::ostringstream out;
  ASSERT_TRUE(list_cameras(system, by_libcamera, out));
  const auto config = parse_config("[rig]\ncamchain = \"rig.yaml\"\n" + out.str(), "locd.toml");
  ASSERT_TRUE(config) << config.error().message << out.str();
  ASSERT_EQ(config->cameras.size(), 1U) << out.str();
  EXPECT_EQ(config->cameras[0].device, "bus=usb-1");
  EXPECT_EQ(config->lcm, LcmOptions());
  EXPECT_EQ(config->record, Config::Record());
  for (const char c : out.str()) EXPECT_TRUE(c < 0 || c == '\n' || (c >= ' ' && c != 0x7f));
}

TEST(ListCameras, SaysThatThereIsNoneAndWhatMayNotBeOpened) {
  test::FakeVideoSystem system;
  std::ostringstream out;
  system.cannot_open = Error{ErrorKind::permission, "group video"};
  EXPECT_TRUE(list_cameras(system, {}, out));
  EXPECT_THAT(out.str(), HasSubstr("group video"));
  system.cameras.clear();
  const Status none = list_cameras(system, {}, out);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::unavailable);
}

}  // namespace
}  // namespace waymark
