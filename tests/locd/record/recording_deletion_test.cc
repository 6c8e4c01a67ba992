// What a ring of recordings must not delete, whatever lies in it and whatever it takes for its own.
#include <sys/stat.h>
#include <unistd.h>

#include "tests/locd/record/recording_fixture.h"
#include "tests/support/disk_double.h"
#include "tests/support/mount_namespace.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;
using std::chrono::hours;
using std::chrono::seconds;
using test::bytes_of;
using test::facts;
using test::generous;
using test::image_bytes;
using test::images_in;
using test::kStart;
using test::open_folder;
using test::set_at;
using test::writes;
using testing::HasSubstr;

/// Five earlier recordings of three sets each.
class Deletion : public testing::Test {
 protected:
  Deletion() {
    with_archive_.archive = tmp_.path() / "archive";
    for (int r = 0; r < 5; ++r) {
      auto folder = open_folder(earlier(r), facts(), generous());
      for (int i = 0; i < 3; ++i) EXPECT_TRUE(writes(*folder, kStart + hours(r) + seconds(i)));
    }
  }
  [[nodiscard]] fs::path earlier(int recording) const {
    return tmp_.path() / "archive" / std::to_string(recording);
  }
  [[nodiscard]] fs::path image(int recording, int set) const {
    const Stamp stamp = kStart + hours(recording) + seconds(set);
    return earlier(recording) / "cam0" / (std::to_string(stamp.count()) + ".pgm");
  }
  /// Files in the earlier recordings that are images, links not counted.
  [[nodiscard]] std::size_t all_images() const {
    std::size_t images = 0;
    for (int r = 0; r < 5; ++r) {
      if (!fs::exists(earlier(r))) continue;
      for (const auto& entry : fs::recursive_directory_iterator(earlier(r))) {
        if (entry.path().extension() == ".pgm" && !entry.is_symlink()) ++images;
      }
    }
    return images;
  }
  /// A new recording, after the others.
  [[nodiscard]] Expected<RecordingFolder> open_new() {
    return open_folder(tmp_.path() / "archive/new", with_archive_, budget_);
  }
  /// That many sets into it; what it had to say.
  std::vector<std::string> record(int sets) {
    auto folder = open_new();
    EXPECT_TRUE(folder);
    for (int i = 0; i < sets; ++i) EXPECT_TRUE(writes(*folder, kStart + hours(10) + seconds(i)));
    return folder->take_notes();
  }

  TemporaryFolder tmp_;
  RecordingFacts with_archive_ = facts();
  RecordingBudget budget_ = generous();
};

TEST_F(Deletion, ALinkToALargeFileIsWorthNothing) {
  fs::resize_file(tmp_.write("large", ""), std::uintmax_t{5} << 40);
  fs::create_symlink(tmp_.path() / "large", earlier(0) / "cam0/1.pgm");
  fs::create_symlink(tmp_.path() / "large", earlier(3) / "cam0/1.pgm");
  budget_.max_bytes = std::uint64_t{1} << 30;
  record(3);
  EXPECT_EQ(all_images(), 30U);
}

TEST_F(Deletion, ALargeFileWithoutBlocksIsWorthNothing) {
  fs::resize_file(image(2, 1), std::uintmax_t{5} << 40);
  budget_.max_bytes = std::uint64_t{1} << 30;
  record(3);
  EXPECT_TRUE(fs::exists(image(0, 0)));
  EXPECT_TRUE(fs::exists(image(2, 1)));
}

TEST_F(Deletion, BackupsByHardLinksStayAndAreNamedOnce) {
  for (int r = 0; r < 5; ++r) {
    for (const char* camera : {"cam0", "cam1"}) {
      for (const auto& entry : fs::directory_iterator(earlier(r) / camera)) {
        const fs::path backup = tmp_.path() / "backup" / std::to_string(r) / camera;
        fs::create_directories(backup);
        fs::create_hard_link(entry.path(), backup / entry.path().filename());
      }
    }
  }
  budget_.max_bytes = bytes_of(2);
  const auto notes = record(10);
  EXPECT_EQ(all_images(), 30U);
  ASSERT_EQ(notes.size(), 5U);
  EXPECT_THAT(notes[0], HasSubstr("6 of its files can't be deleted"));
  EXPECT_THAT(notes[0], HasSubstr("it has 2 names"));
}

TEST_F(Deletion, WhereDeletingFreesNothingNoMoreIsDeleted) {
  test::DiskDouble disk;
  constexpr std::uint64_t kFloor = 1 << 20;
  disk.say_free([] { return kFloor; });  // as with snapshots of the disk
  budget_.min_free_bytes = kFloor;
  auto folder = open_new();
  ASSERT_TRUE(folder);
  const auto refused = folder->write_set(set_at(kStart + hours(10)));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("snapshots"));
  EXPECT_EQ(all_images(), 28U);  // one set was the attempt
}

TEST_F(Deletion, AnotherUsersRecordingsStayDoNotCountAndAreNamedOnce) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root gives files away";
  for (const auto& entry : fs::recursive_directory_iterator(earlier(0))) {
    ASSERT_EQ(::chown(entry.path().c_str(), 12345, 12345), 0);
  }
  budget_.max_bytes = bytes_of(3);
  const auto notes = record(20);
  EXPECT_EQ(images_in(earlier(0)), 6U);
  for (int r = 1; r < 5; ++r) EXPECT_FALSE(fs::exists(earlier(r))) << r;
  EXPECT_EQ(images_in(tmp_.path() / "archive/new"), 6U);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_THAT(notes[0], HasSubstr("it belongs to user 12345"));
}

TEST_F(Deletion, AMountedDiskIsAnothers) {
  if (!test::enter_mount_namespace()) GTEST_SKIP() << "no mount namespace here";
  tmp_.write("disk/readme", "");
  fs::copy(earlier(0), tmp_.path() / "disk/0", fs::copy_options::recursive);
  const test::BindMount whole(tmp_.path() / "disk/0", earlier(0));
  const test::BindMount camera(tmp_.path() / "disk/0/cam0", earlier(1) / "cam0");
  ASSERT_TRUE(whole.is_there() && camera.is_there());
  budget_.max_bytes = bytes_of(2);
  record(30);
  EXPECT_EQ(images_in(tmp_.path() / "disk/0"), 6U);
  EXPECT_FALSE(fs::exists(earlier(2)));
}

TEST_F(Deletion, WhatElseLiesInARecordingStays) {
  tmp_.write("archive/0/report/index.html", "ours");
  tmp_.write("archive/1/cam0/notes.txt", "ours");
  tmp_.write("archive/2/cam0/.5.part", "theirs");
  tmp_.write("archive/3/cam0/five.pgm", "theirs");
  budget_.max_bytes = bytes_of(2);
  record(30);
  EXPECT_EQ(tmp_.read("archive/0/report/index.html"), "ours");
  EXPECT_EQ(tmp_.read("archive/1/cam0/notes.txt"), "ours");
  EXPECT_EQ(tmp_.read("archive/2/cam0/.5.part"), "theirs");
  EXPECT_EQ(tmp_.read("archive/3/cam0/five.pgm"), "theirs");
  for (int r = 0; r < 4; ++r) EXPECT_FALSE(fs::exists(earlier(r) / "capture.toml")) << r;
  EXPECT_FALSE(fs::exists(earlier(4)));
}

TEST_F(Deletion, WhatAKillLeftGoesWithItsRecording) {
  tmp_.write("archive/0/cam0/." + image(0, 1).filename().string() + ".part", "half");
  tmp_.write("archive/0/.frames.csv.0123456789abcdef", "half");
  budget_.max_bytes = bytes_of(2);
  record(30);
  EXPECT_FALSE(fs::exists(earlier(0)));
}

TEST_F(Deletion, ABudgetBelowOneSetIsRefusedAndNothingIsDeleted) {
  budget_.max_bytes = test::set_bytes() / 2;
  auto folder = open_new();
  ASSERT_TRUE(folder);
  const auto refused = folder->write_set(set_at(kStart + hours(10)));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("max_bytes"));
  EXPECT_EQ(all_images(), 30U);
}

TEST_F(Deletion, AnArchiveOnASlowDiskHoldsUpNeitherTheStartNorTheSets) {
  test::DiskDouble disk;
  disk.stall_listing("archive");
  budget_.max_bytes = bytes_of(2);
  auto folder = RecordingFolder::open(tmp_.path() / "archive/new", with_archive_, budget_);
  ASSERT_TRUE(folder);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(writes(*folder, kStart + hours(10) + seconds(i)));
  EXPECT_FALSE(folder->knows_what_was_there());
  EXPECT_EQ(all_images(), 30U);
  disk.release();
  ASSERT_TRUE(test::know(*folder));
  for (int i = 5; i < 30; ++i) ASSERT_TRUE(writes(*folder, kStart + hours(10) + seconds(i)));
  EXPECT_EQ(all_images(), 0U);
  EXPECT_EQ(folder->sets(), 2U);
}

TEST_F(Deletion, WhileItIsNotKnownWhatIsOldestASetWaitsForRoomInVain) {
  test::DiskDouble disk;
  disk.stall_listing("archive");
  constexpr std::uint64_t kFloor = 1 << 20;
  disk.say_free([this] { return kFloor + test::set_bytes() * (30 - all_images()) / 2; });
  budget_.min_free_bytes = kFloor;
  auto folder = RecordingFolder::open(tmp_.path() / "archive/new", with_archive_, budget_);
  ASSERT_TRUE(folder);
  EXPECT_FALSE(writes(*folder, kStart + hours(10)));
  EXPECT_EQ(all_images(), 30U);
  disk.release();
  ASSERT_TRUE(test::know(*folder));
  EXPECT_TRUE(writes(*folder, kStart + hours(10) + seconds(1)));
  EXPECT_EQ(all_images(), 26U);
}

TEST_F(Deletion, AnotherCodecsImagesCountAndKeepTheirRows) {
  RecordingFacts jpeg = facts();
  jpeg.codec = "jpeg";
  const fs::path ring = tmp_.path() / "ring";
  {
    auto folder = open_folder(ring, jpeg, generous());
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(i)));
  }
  budget_.max_bytes = bytes_of(8);
  auto folder = open_folder(ring, facts(), budget_);
  ASSERT_TRUE(folder);
  EXPECT_EQ(folder->sets(), 10U);
  ASSERT_TRUE(writes(*folder, kStart + seconds(10)));
  ASSERT_TRUE(writes(*folder, kStart + seconds(11)));
  EXPECT_EQ(folder->sets(), 8U);
  const std::string table = tmp_.read("ring/frames.csv");
  for (int i = 4; i < 12; ++i) {
    EXPECT_THAT(table, HasSubstr(fmt::format("cam0,{},", (kStart + seconds(i)).count()))) << i;
  }
  for (int i = 12; i < 30; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(i)));
  EXPECT_EQ(folder->sets(), 8U);
  for (const auto& entry : fs::directory_iterator(ring / "cam0")) {
    EXPECT_EQ(entry.path().extension(), ".pgm");
  }
}

/// What --record may find in its folder that somebody has prepared on a removable disk.
class PreparedFolder : public testing::Test {
 protected:
  PreparedFolder() {
    auto folder = open_folder(tmp_.path() / "ring", facts(), generous());
    EXPECT_TRUE(writes(*folder, kStart));
    for (int i = 0; i < 20; ++i) {
      tmp_.write(fmt::format("theirs/{}.pgm", kStart.count() + i), image_bytes());
    }
    tmp_.write("theirs/.1.pgm.part", "half");
    tmp_.write("table", "no line end");
  }
  [[nodiscard]] fs::path ring(const char* name) const { return tmp_.path() / "ring" / name; }
  void expect_refused(const std::string& name) const {
    const auto refused = RecordingFolder::open(tmp_.path() / "ring", facts(), generous());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::cant_create);
    EXPECT_THAT(refused.error().message, HasSubstr(name));
    EXPECT_EQ(std::distance(fs::directory_iterator(tmp_.path() / "theirs"), {}), 21);
    EXPECT_EQ(tmp_.read("table"), "no line end");
  }

  TemporaryFolder tmp_;
};

TEST_F(PreparedFolder, ACameraFolderThatIsALinkIsRefused) {
  fs::remove_all(ring("cam0"));
  fs::create_directory_symlink(tmp_.path() / "theirs", ring("cam0"));
  expect_refused("cam0");
}

TEST_F(PreparedFolder, ACameraFolderThatIsMountedIsRefused) {
  if (!test::enter_mount_namespace()) GTEST_SKIP() << "no mount namespace here";
  const test::BindMount mount(tmp_.path() / "theirs", ring("cam0"));
  ASSERT_TRUE(mount.is_there());
  expect_refused("cam0");
}

TEST_F(PreparedFolder, ATableThatIsALinkIsRefused) {
  fs::remove(ring("frames.csv"));
  fs::create_symlink(tmp_.path() / "table", ring("frames.csv"));
  expect_refused("frames.csv");
}

TEST_F(PreparedFolder, ATableOfTwoNamesIsRefused) {
  fs::remove(ring("frames.csv"));
  fs::create_hard_link(tmp_.path() / "table", ring("frames.csv"));
  expect_refused("frames.csv");
}

TEST_F(PreparedFolder, ATableThatIsAPipeIsRefusedAtOnce) {
  fs::remove(ring("frames.csv"));
  ASSERT_EQ(::mkfifo(ring("frames.csv").c_str(), 0600), 0);
  expect_refused("frames.csv");
}

TEST_F(PreparedFolder, TextsThatAreLinksAreRefused) {
  fs::copy(ring("markers.toml"), tmp_.path() / "markers.toml");
  fs::remove(ring("markers.toml"));
  fs::create_symlink(tmp_.path() / "markers.toml", ring("markers.toml"));
  expect_refused("markers.toml");
}

TEST_F(PreparedFolder, HalfWrittenFilesOfOthersStay) {
  fs::create_symlink(tmp_.path() / "table", ring("cam0") / ".1.pgm.part");
  fs::create_hard_link(tmp_.path() / "table", ring("cam0") / ".2.pgm.part");
  auto folder = open_folder(tmp_.path() / "ring", facts(), generous());
  ASSERT_TRUE(folder) << folder.error().message;
  EXPECT_TRUE(fs::is_symlink(ring("cam0") / ".1.pgm.part"));
  EXPECT_TRUE(fs::exists(ring("cam0") / ".2.pgm.part"));
  EXPECT_EQ(tmp_.read("table"), "no line end");
}

TEST_F(PreparedFolder, AnImageIsNeverWrittenThroughALink) {
  auto folder = open_folder(tmp_.path() / "ring", facts(), generous());
  ASSERT_TRUE(folder);
  const Stamp stamp = kStart + seconds(1);
  fs::create_symlink(tmp_.path() / "table",
                     ring("cam0") / fmt::format(".{}.pgm.part", stamp.count()));
  const auto refused = folder->write_set(set_at(stamp));
  ASSERT_FALSE(refused);
  EXPECT_EQ(tmp_.read("table"), "no line end");
}

}  // namespace
}  // namespace waymark
