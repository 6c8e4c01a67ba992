#include "locd/service/camera_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "drivers/replay_source.h"
#include "drivers/v4l2/v4l2_source.h"
#include "tests/drivers/v4l2/fake_video_system.h"
#include "tests/support/room_capture.h"

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A scripted camera as --check sees it.
class CheckCameras : public testing::Test {
 protected:
  [[nodiscard]] Status check(std::optional<int> owner) {
    CameraOptions options;
    options.name = "cam0";
    options.device.serial = serial_;
    options.request = {64, 48, nullptr, 30};
    std::vector<std::unique_ptr<FrameSource>> cameras;
    cameras.push_back(v4l2_source(system_, options));
    std::ostringstream out;
    const Status checked = check_cameras(cameras, owner, out);
    printed_ = out.str();
    return checked;
  }
  [[nodiscard]] test::FakeDevice& camera() { return system_->cameras.front(); }

  std::string serial_ = "4711";
  std::shared_ptr<test::FakeVideoSystem> system_ = std::make_shared<test::FakeVideoSystem>();
  std::string printed_;
};

TEST_F(CheckCameras, SayWhatTheDeviceIsAndDoesAndGiveItBack) {
  camera().frames.push_back({std::vector<std::uint8_t>(64 * 48), 0, system_->time});
  const Status checked = check(std::nullopt);
  EXPECT_TRUE(checked) << checked.error().message;
  EXPECT_THAT(printed_,
              HasSubstr("cam0: /dev/video0 (Fake, usb-1, serial 4711), offers GREY 64×48"));
  EXPECT_THAT(printed_, HasSubstr("cam0: GREY 64×48 at 30/s"));
  EXPECT_EQ(camera().opened, 0);
}

TEST_F(CheckCameras, LeaveWhatARunningLocdHasAlone) {
  camera().holders = {{99, "cheese"}, {1234, "locd"}};
  EXPECT_TRUE(check(1234));
  EXPECT_THAT(printed_, HasSubstr("in use by the running locd (pid 1234)"));
  EXPECT_EQ(camera().starts, 0);
  const Status of_another = check(4321);
  ASSERT_FALSE(of_another);
  EXPECT_THAT(of_another.error().message, HasSubstr("cam0: /dev/video0"));
  EXPECT_THAT(of_another.error().message, HasSubstr("cheese (pid 99), locd (pid 1234) uses it"));
}

TEST_F(CheckCameras, FailWithoutTheCameraAndWithoutFrames) {
  const Status silent = check(std::nullopt);
  ASSERT_FALSE(silent);
  EXPECT_THAT(silent.error().message, HasSubstr("trigger"));
  serial_ = "0815";
  const Status absent = check(std::nullopt);
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().kind, ErrorKind::unavailable);
  EXPECT_THAT(printed_, Not(HasSubstr("offers")));
}

TEST(CheckReplayedCameras, SaysWhatTheyPlay) {
  test::RoomOptions room;
  room.frame_sets = 3;
  const TemporaryFolder folder;
  test::write_room_capture(folder, test::make_room(room));
  ReplayOptions options;
  options.realtime = options.loop = true;
  const auto capture = ReplayCapture::open(folder.path(), options);
  ASSERT_TRUE(capture) << capture.error().message;
  std::ostringstream out;
  ASSERT_TRUE(check_cameras(ReplayCapture::sources(*capture), std::nullopt, out));
  std::istringstream lines(out.str());
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    EXPECT_GT(line.size(), std::string("cam0: ").size()) << line;
  }
  EXPECT_EQ(count, 6);
  EXPECT_THAT(out.str(), HasSubstr("cam1: 1280×960, replayed again and again"));
}

}  // namespace
}  // namespace waymark
