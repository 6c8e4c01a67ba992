// Recordings as the daemon's operators see them.
#include "core/capture/capture_folder.h"
#include "tests/locd/daemon_fixture.h"

namespace waymark {
namespace {

using test::DaemonTest;
using testing::HasSubstr;

TEST_F(DaemonTest, RecordsOnRequest) {
  start();
  EXPECT_THAT(request("status"), HasSubstr("not recording"));
  const std::string started = request("start");
  ASSERT_THAT(started, testing::StartsWith("ok "));
  EXPECT_THAT(request("start"), HasSubstr("error"));
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return !statuses_.empty() && statuses_.back().recorded_sets > 3;
  }));
  EXPECT_NE(statuses_.back().recording, 0);
  EXPECT_EQ("ok " + statuses_.back().recording_path + "\n", started);
  EXPECT_THAT(request("stop"), testing::StartsWith("ok "));
  const auto folder = started.substr(3, started.size() - 4);
  const auto capture = open_capture_folder(folder);
  ASSERT_TRUE(capture) << capture.error().message;
  EXPECT_GE(capture->images.size(), 8U);
  EXPECT_THAT(request("shutdown"), HasSubstr("error"));
}

TEST_F(DaemonTest, AnArchiveThatCantBeReachedIsAnAnswer) {
  std::filesystem::create_directory_symlink("recordings", tmp_.path() / "recordings");  // a loop
  start();
  EXPECT_THAT(request("start"), testing::StartsWith("error: "));
  turn_for(std::chrono::seconds(2));
  ASSERT_FALSE(statuses_.empty());
  EXPECT_EQ(statuses_.back().recording, 0);
}

}  // namespace
}  // namespace waymark
