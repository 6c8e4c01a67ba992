// Recordings as the daemon's operators see them.
#include <cstdlib>

#include "core/capture/capture_folder.h"
#include "core/capture/image_file.h"
#include "tests/locd/service/daemon_fixture.h"
#include "tests/support/disk_double.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::DaemonTest;
using test::DiskDouble;
using testing::HasSubstr;
using testing::StartsWith;

TEST_F(DaemonTest, RecordsOnRequest) {
  start();
  EXPECT_THAT(request("status"), HasSubstr("not recording"));
  const std::string started = request("start");
  ASSERT_THAT(started, StartsWith("ok "));
  EXPECT_THAT(request("start"), HasSubstr("error"));
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return !statuses_.empty() && statuses_.back().recorded_sets > 3;
  }));
  EXPECT_NE(statuses_.back().recording, 0);
  EXPECT_EQ("ok " + statuses_.back().recording_path + "\n", started);
  EXPECT_THAT(request("stop"), StartsWith("ok "));
  const auto folder = started.substr(3, started.size() - 4);
  const auto capture = open_capture_folder(folder);
  ASSERT_TRUE(capture) << capture.error().message;
  EXPECT_GE(capture->images.size(), 8U);
  EXPECT_THAT(request("shutdown"), HasSubstr("error"));
}

TEST_F(DaemonTest, AnArchiveThatCantBeReachedIsAnAnswer) {
  std::filesystem::create_directory_symlink("recordings", tmp_.path() / "recordings");  // a loop
  start();
  EXPECT_THAT(request("start"), StartsWith("error: "));
  turn_for(seconds(2));
  ASSERT_FALSE(statuses_.empty());
  EXPECT_EQ(statuses_.back().recording, 0);
}

TEST_F(DaemonTest, ADiskThatStallsHoldsUpNeitherWatchdogNorPosesNorAnswers) {
  test::FakeSystemd& systemd = with_systemd();
  DiskDouble disk;
  start();
  const auto goes_on = [&] {
    (void)systemd.heard();
    poses_.clear();
    return turn_until([&] { return systemd.heard().find("WATCHDOG=1") != std::string::npos; }) &&
           turn_until([&] { return !poses_.empty(); });
  };
  const auto held = [&] { return disk.holds_somebody(Stamp{0}); };
  disk.stall();
  const Descriptor begins = ask("start");
  ASSERT_TRUE(turn_until(held));
  EXPECT_TRUE(goes_on());
  EXPECT_EQ(request("status"), "ok starting\n");
  EXPECT_THAT(request("start"), StartsWith("error: "));
  EXPECT_EQ(answer_to(begins), "");
  disk.release();
  std::string folder;
  ASSERT_TRUE(turn_until([&] { return !(folder = answer_to(begins)).empty(); }));
  EXPECT_THAT(folder, StartsWith("ok /"));
  disk.stall();
  const Descriptor ends = ask("stop");
  ASSERT_TRUE(turn_until(held));
  EXPECT_TRUE(goes_on());
  EXPECT_EQ(request("status"), "ok stopping\n");
  EXPECT_THAT(request("start"), StartsWith("error: "));
  EXPECT_EQ(answer_to(ends), "");
  disk.release();
  std::string ended;
  ASSERT_TRUE(turn_until([&] { return !(ended = answer_to(ends)).empty(); }));
  EXPECT_EQ(ended, folder);
}

TEST_F(DaemonTest, ADiskThatDoesNotAnswerIsSaidAfterAWhile) {
  DiskDouble disk;
  start();
  disk.stall();
  const Descriptor begins = ask("start");
  turn_for(seconds(9));
  EXPECT_EQ(answer_to(begins), "");
  turn_for(seconds(2));
  EXPECT_THAT(answer_to(begins), HasSubstr("the disk does not answer"));
  disk.release();
  ASSERT_TRUE(turn_until([&] { return request("status") == "ok not recording\n"; }));
  ASSERT_THAT(request("start"), StartsWith("ok "));
  disk.stall();
  const Descriptor ends = ask("stop");
  turn_for(seconds(9));
  EXPECT_EQ(answer_to(ends), "");
  turn_for(seconds(2));
  EXPECT_EQ(answer_to(ends), "ok stopping\n");
  disk.release();
  EXPECT_TRUE(turn_until([&] { return request("status") == "ok not recording\n"; }));
}

TEST_F(DaemonTest, WhatWasRecordedIsOnTheDiskAtTheEndWhateverADriverDoes) {
  DiskDouble disk;
  start();
  const std::string answer = request("start");
  ASSERT_THAT(answer, StartsWith("ok "));
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return !statuses_.empty() && statuses_.back().recorded_sets > 3;
  }));
  cameras_[0]->get_stuck();
  ASSERT_TRUE(turn_until([&] { return cameras_[0]->is_stuck(); }));
  const Stamp before = monotonic_now();
  const Status ended = daemon_->stop(seconds(3));
  EXPECT_LT(monotonic_now() - before, seconds(8)) << "it waited for the driver";
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().message, "a camera's driver does not return; ending without");
  const auto capture = open_capture_folder(answer.substr(3, answer.size() - 4));
  ASSERT_TRUE(capture) << capture.error().message;
  EXPECT_GE(capture->images.size(), 8U);
  for (const ImageFile& image : capture->images) {
    EXPECT_TRUE(disk.synced().contains(image.path.string())) << image.path;
  }
}

TEST_F(DaemonTest, TheEndDoesNotWaitForTheDisk) {
  DiskDouble disk;
  start();
  ASSERT_THAT(request("start"), StartsWith("ok "));
  disk.stall();
  const Stamp before = monotonic_now();
  const Status ended = daemon_->stop(seconds(3));
  EXPECT_LT(monotonic_now() - before, seconds(8)) << "it waited for the disk";
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().message, "the disk does not take the recording; ending without");
  disk.release();
}

TEST_F(DaemonTest, AStartThatTheDiskHoldsUpFailsAndCanBeEnded) {
  DiskDouble disk;
  disk.stall();
  make([](test::FakeCamera& /*camera*/) {}, tmp_.path() / "capture");
  const Status started = daemon_->start();
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("the disk does not answer"));
  const Status ended = daemon_->stop(milliseconds(100));
  ASSERT_FALSE(ended);
  EXPECT_THAT(ended.error().message, HasSubstr("the disk does not take the recording"));
  disk.release();
}

TEST_F(DaemonTest, AReloadedBudgetHoldsForTheRecordingThatRuns) {
  start();
  const std::string answer = request("start");
  ASSERT_THAT(answer, StartsWith("ok "));
  const auto kept = [&]() -> Stamp {  // from the oldest image to the newest
    const auto capture = open_capture_folder(answer.substr(3, answer.size() - 4));
    if (!capture || capture->images.empty()) return Stamp{0};
    return capture->images.back().stamp - capture->images.front().stamp;
  };
  const auto record_until = [&](const auto& holds) {
    return turn_until([&] {
      if (monotonic_now() - last_given_ < milliseconds(100)) return false;
      give_set();
      return holds();
    });
  };
  ASSERT_TRUE(record_until([&] { return kept() > milliseconds(1500); }));
  write_config("keep_s = 1\n");
  reload();
  EXPECT_TRUE(record_until([&] { return kept() <= milliseconds(1100); }));
}

TEST_F(DaemonTest, ARecordingWithoutMarkersSaysWhatToSet) {
  tmp_.write("locd.toml",
             "[rig]\ncamchain = \"rig.yaml\"\n[lcm]\nurl = \"memq://\"\n"
             "[[camera]]\nname = \"cam0\"\ndriver = \"v4l2\"\ndevice = \"left\"\n"
             "[[camera]]\nname = \"cam1\"\ndriver = \"v4l2\"\ndevice = \"right\"\n"
             "[record]\ndir = \"recordings\"\nmin_free_bytes = 0\n");
  start();
  const std::string answer = request("start");
  ASSERT_THAT(answer, StartsWith("ok "));
  ASSERT_TRUE(turn_until([&] { return alert("RECORDING", false) != nullptr; }));
  EXPECT_THAT(alert("RECORDING", false)->text, HasSubstr("without markers.toml"));
  EXPECT_THAT(alert("RECORDING", false)->text, HasSubstr("[record] markers"));
  EXPECT_FALSE(std::filesystem::exists(answer.substr(3, answer.size() - 4) + "/markers.toml"));
}

TEST_F(DaemonTest, AnArchiveOnASlowDiskHoldsUpNoAnswer) {
  test::FakeSystemd& systemd = with_systemd();
  tmp_.write("recordings/earlier/readme", "");
  DiskDouble disk;
  start();
  disk.stall_listing("recordings");
  EXPECT_THAT(request("start"), StartsWith("ok /"));
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return !statuses_.empty() && statuses_.back().recorded_sets > 3;
  }));
  EXPECT_THAT(systemd.heard(), HasSubstr("WATCHDOG=1"));
  disk.release();
  EXPECT_THAT(request("stop"), StartsWith("ok /"));
}

TEST_F(DaemonTest, RecordingsGoBelowTheStateFolderWhereNothingElseIsSaid) {
  tmp_.write("locd.toml",
             "[rig]\ncamchain = \"rig.yaml\"\n[lcm]\nurl = \"memq://\"\n"
             "[[camera]]\nname = \"cam0\"\ndriver = \"v4l2\"\ndevice = \"left\"\n"
             "[[camera]]\nname = \"cam1\"\ndriver = \"v4l2\"\ndevice = \"right\"\n"
             "[record]\nmin_free_bytes = 0\n");
  start();
  EXPECT_THAT(request("start"), StartsWith("ok " + (tmp_.path() / "recordings").string() + "/"));
}

/// Recordings of one vehicle, started again and again under clocks of all kinds.
class ClocksAndRecordings : public DaemonTest {
 protected:
  ClocksAndRecordings() { write_config("keep_s = 1\n"); }

  /// Records for a while in a run of locd of its own; the folder.
  std::filesystem::path record_under(Stamp wall, bool vouched_for) {
    clocks_.wall_ahead = wall - monotonic_now();
    clocks_.vouched_for = vouched_for;
    start();
    const std::string answer = request("start");
    EXPECT_THAT(answer, StartsWith("ok "));
    EXPECT_TRUE(turn_until([&] {
      give_set();
      return !statuses_.empty() && statuses_.back().recorded_sets > 3;
    }));
    EXPECT_THAT(request("stop"), StartsWith("ok "));
    EXPECT_TRUE(daemon_->stop(seconds(20)));
    daemon_.reset();
    cameras_.clear();
    statuses_.clear();
    return answer.substr(3, answer.size() - 4);
  }
  static std::size_t images_in(const std::filesystem::path& folder) {
    const auto capture = open_capture_folder(folder);
    return capture ? capture->images.size() : 0;
  }

  static constexpr Stamp kToday = seconds(1'800'000'000);
};

TEST_F(ClocksAndRecordings, ARoundOf1970IsNotDeletedOnceTheClockIsRight) {
  const auto round = record_under(seconds(100), false);
  const std::size_t images = images_in(round);
  EXPECT_GT(images, 0U);
  record_under(kToday, true);
  EXPECT_EQ(images_in(round), images);
}

TEST_F(ClocksAndRecordings, AClockThatIsYearsAheadDeletesNothing) {
  const auto round = record_under(kToday, true);
  const std::size_t images = images_in(round);
  record_under(kToday + std::chrono::hours(9 * 365 * 24), false);
  EXPECT_EQ(images_in(round), images);
  record_under(kToday + std::chrono::milliseconds(100), false);
  EXPECT_EQ(images_in(round), images);
}

TEST_F(ClocksAndRecordings, WhatIsOldByClocksThatWereKeptGoes) {
  const auto round = record_under(kToday, true);
  EXPECT_GT(images_in(round), 0U);
  clocks_.wall_ahead += std::chrono::hours(1);
  start();
  ASSERT_THAT(request("start"), StartsWith("ok "));
  EXPECT_TRUE(turn_until([&] {
    give_set();
    return !std::filesystem::exists(round);
  }));
}

TEST_F(ClocksAndRecordings, AClockThatIsCorrectedWhileItRecordsDatesNothing) {
  const auto round = record_under(kToday, true);
  const std::size_t images = images_in(round);
  clocks_.wall_ahead = seconds(100) - monotonic_now();
  clocks_.vouched_for = false;
  start();
  ASSERT_THAT(request("start"), StartsWith("ok "));
  clocks_.wall_ahead += kToday + std::chrono::hours(1);  // a time service has come
  clocks_.vouched_for = true;
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return !statuses_.empty() && statuses_.back().recorded_sets > 3;
  }));
  EXPECT_EQ(images_in(round), images);
}

TEST_F(DaemonTest, AFramesNameIsItsPosesUtimeAlsoWhileUtimeFollowsTheClock) {
  start();
  const std::string answer = request("start");
  ASSERT_THAT(answer, StartsWith("ok "));
  clocks_.wall_ahead += seconds(30);  // utime comes after it for hours
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return !statuses_.empty() && statuses_.back().recorded_sets > 40;
  }));
  ASSERT_THAT(request("stop"), StartsWith("ok "));
  const auto capture = open_capture_folder(answer.substr(3, answer.size() - 4));
  ASSERT_TRUE(capture) << capture.error().message;
  std::size_t found = 0;
  for (const ImageFile& image : capture->images) {
    const std::int64_t name_us = image.stamp.count() / 1000;
    for (const pose_t& pose : poses_) {  // a set that was passed over has none
      if (std::abs(pose.utime - name_us) > 5000) continue;
      EXPECT_EQ(pose.utime, name_us);
      ++found;
    }
  }
  EXPECT_GT(found, 20U);
}

TEST_F(DaemonTest, AQuarantineThatCantBeReadIsSaidAndKept) {
  tmp_.write("quarantine.json", "{\"map_ha");
  start();
  turn_for(seconds(2));
  ASSERT_NE(alert("QUARANTINE", true), nullptr);
  EXPECT_THAT(alert("QUARANTINE", true)->text, HasSubstr("quarantine.json.damaged"));
  ASSERT_FALSE(statuses_.empty());
  EXPECT_THAT(statuses_.back().text, HasSubstr("quarantine.json.damaged"));
  EXPECT_EQ(tmp_.read("quarantine.json.damaged"), "{\"map_ha");
}

}  // namespace
}  // namespace waymark
