#include "locd/camera_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "locd/config.h"
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
  ASSERT_TRUE(list_cameras(system, out));
  const auto config = parse_config("[rig]\ncamchain = \"rig.yaml\"\n" + out.str(), "locd.toml");
  ASSERT_TRUE(config) << config.error().message;
  ASSERT_EQ(config->cameras.size(), 2U);
  EXPECT_EQ(config->cameras[0].device, "serial=left");
  EXPECT_EQ(config->cameras[0].format, "GREY");
  EXPECT_EQ(config->cameras[1].name, "cam1");
  EXPECT_EQ(config->cameras[1].device, "serial=right");
  EXPECT_EQ(config->cameras[1].format, "YUYV");
}

TEST(ListCameras, SaysOfThoseThatCantBeToldApart) {
  test::FakeVideoSystem system;
  system.cameras.push_back({});
  std::ostringstream out;
  ASSERT_TRUE(list_cameras(system, out));
  EXPECT_THAT(out.str(), HasSubstr("# can't be told from another camera"));
  EXPECT_EQ(out.str().find("[[camera]]"), std::string::npos);
}

TEST(ListCameras, SaysThatThereIsNoneAndWhatMayNotBeOpened) {
  test::FakeVideoSystem system;
  std::ostringstream out;
  system.cannot_open = Error{ErrorKind::permission, "group video"};
  EXPECT_TRUE(list_cameras(system, out));
  EXPECT_THAT(out.str(), HasSubstr("group video"));
  system.cameras.clear();
  const Status none = list_cameras(system, out);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::unavailable);
}

}  // namespace
}  // namespace waymark
