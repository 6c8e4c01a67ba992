#include "locd/record/recording_folder.h"

#include <algorithm>
#include <optional>

#include "tests/locd/record/recording_fixture.h"
#include "tests/support/disk_double.h"
#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

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

TEST(RecordingFolder, IsACaptureFromTheFirstSetOn) {
  const TemporaryFolder tmp;
  auto folder = open_folder(tmp.path() / "a" / "b", facts(), generous());
  ASSERT_TRUE(folder) << folder.error().message;
  ASSERT_TRUE(writes(*folder, kStart));
  const auto capture = open_capture_folder(tmp.path() / "a" / "b");
  ASSERT_TRUE(capture) << capture.error().message;
  ASSERT_EQ(capture->images.size(), 2U);
  EXPECT_EQ(capture->images[0].stamp, kStart);
  EXPECT_EQ(capture->session, "0123456789abcdef");
  EXPECT_EQ(capture->sync_tolerance, std::chrono::milliseconds(5));
  EXPECT_EQ(capture->rig.cameras.size(), 2U);
  EXPECT_EQ(tmp.read("a/b/frames.csv"),
            "camera,t_ns,exposure_ns,sequence,stamp_quality\n"
            "cam0,1800000000000000000,250000,42,exact\n"
            "cam1,1800000000000001000,250000,42,exact\n");
  EXPECT_TRUE(folder->sync());
  EXPECT_EQ(folder->sets(), 1U);
}

TEST(RecordingFolder, IsARingByBytes) {
  const TemporaryFolder tmp;
  RecordingBudget budget = generous();
  budget.max_bytes = bytes_of(10);
  auto folder = open_folder(tmp.path(), facts(), budget);
  ASSERT_TRUE(folder);
  for (int i = 0; i < 25; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(i)));
  EXPECT_EQ(folder->sets(), 10U);
  EXPECT_EQ(images_in(tmp.path()), 20U);
  EXPECT_EQ(open_capture_folder(tmp.path())->images.front().stamp, kStart + seconds(15));
}

TEST(RecordingFolder, IsARingByAge) {
  const TemporaryFolder tmp;
  RecordingBudget budget = generous();
  budget.keep = seconds(5);
  auto folder = open_folder(tmp.path(), facts(), budget);
  ASSERT_TRUE(folder);
  for (int i = 0; i < 25; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(i)));
  EXPECT_EQ(folder->sets(), 6U);  // 19 … 24
  EXPECT_EQ(images_in(tmp.path()), 12U);
}

/// A kill may come at any moment, and a locd that was down for longer than a ring is long finds
/// only outdated sets in it.
TEST(RecordingFolder, OutdatedSetsGoOnlyOnceAnotherIsThere) {
  const TemporaryFolder tmp;
  RecordingBudget budget = generous();
  budget.keep = seconds(1);
  ASSERT_TRUE(open_folder(tmp.path(), facts(), budget)->write_set(set_at(kStart)));
  auto folder = open_folder(tmp.path(), facts(), budget);
  ASSERT_TRUE(folder);
  {
    const test::FullDisk full(1000);
    ASSERT_FALSE(folder->write_set(set_at(kStart + seconds(60))));
  }
  EXPECT_EQ(images_in(tmp.path()), 2U);
  ASSERT_TRUE(writes(*folder, kStart + seconds(120)));
  EXPECT_EQ(open_capture_folder(tmp.path())->images.front().stamp, kStart + seconds(120));
}

/// Budget, folder and a disk of which the folder's images are the only thing that changes.
class RingOnADisk {
 public:
  explicit RingOnADisk(std::uint64_t min_free_bytes) {
    RecordingBudget budget = generous();
    budget.min_free_bytes = min_free_bytes;
    folder_.emplace(std::move(*open_folder(tmp_.path(), facts(), budget)));
    disk_.say_free([this] { return capacity_ - kSet * folder_->sets(); });
  }
  static inline const std::uint64_t kSet = test::set_bytes();
  static inline const std::uint64_t kRows = 200;  ///< more than a set's rows take
  RecordingFolder& folder() { return *folder_; }
  /// Somebody else takes or gives space.
  void resize(std::uint64_t capacity) { capacity_ = capacity; }

 private:
  TemporaryFolder tmp_;
  test::DiskDouble disk_;
  std::optional<RecordingFolder> folder_;
  std::uint64_t capacity_ = std::uint64_t{1} << 40;
};

constexpr std::uint64_t kFloor = 1 << 20;
/// What fstatvfs tells is whole blocks.
constexpr std::uint64_t kBlock = 4096;

TEST(RecordingFolder, TheRingMakesRoomUnderTheFloorOfFreeSpace) {
  RingOnADisk ring(kFloor);
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(writes(ring.folder(), kStart + seconds(i)));
  }
  ring.resize(kFloor + 4 * RingOnADisk::kSet + kBlock);
  ASSERT_TRUE(writes(ring.folder(), kStart + seconds(5)));
  EXPECT_EQ(ring.folder().sets(), 4U);
}

TEST(RecordingFolder, NothingIsDeletedWhereThatCantHelp) {
  RingOnADisk ring(kFloor);
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(writes(ring.folder(), kStart + seconds(i)));
  }
  ring.resize(kFloor + RingOnADisk::kSet - kBlock);  // with all five deleted, less than a set
  const auto refused = ring.folder().write_set(set_at(kStart + seconds(5)));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::io);
  EXPECT_THAT(refused.error().message, HasSubstr("min_free_bytes"));
  EXPECT_EQ(ring.folder().sets(), 5U);
}

TEST(RecordingFolder, TheTableIsOfTheFolder) {
  const TemporaryFolder tmp;
  auto folder = open_folder(tmp.path(), facts(), generous());
  ASSERT_TRUE(folder);
  ASSERT_TRUE(writes(*folder, kStart));
  EXPECT_EQ(folder->bytes(), test::set_bytes() + tmp.read("frames.csv").size());
}

std::size_t rows_in(const TemporaryFolder& tmp) {
  const std::string table = tmp.read("frames.csv");
  return static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')) - 1;
}

TEST(RecordingFolder, TheTableForgetsDeletedSetsOnceTheyAreMoreThanHalf) {
  const TemporaryFolder tmp;
  RecordingBudget budget = generous();
  budget.keep = seconds(5);  // with the one that is written: six sets, twelve rows
  auto folder = open_folder(tmp.path(), facts(), budget);
  ASSERT_TRUE(folder);
  for (int i = 0; i < 12; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(i)));
  EXPECT_EQ(rows_in(tmp), 24U);  // twelve of images that are there, twelve of others
  ASSERT_TRUE(writes(*folder, kStart + seconds(12)));
  EXPECT_EQ(rows_in(tmp), 12U);
  for (int i = 13; i < 40; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(i)));
  EXPECT_LE(rows_in(tmp), 24U);
  for (int i = 34; i < 40; ++i) {
    EXPECT_THAT(tmp.read("frames.csv"),
                HasSubstr(fmt::format("cam1,{},", (kStart + seconds(i)).count() + 1000)));
  }
  EXPECT_EQ(images_in(tmp.path()), 12U);
}

TEST(RecordingFolder, TheTableListsNoMoreDeletedThanKeptImagesAlsoWhileRoomIsMade) {
  const TemporaryFolder tmp;
  test::DiskDouble disk;
  RecordingBudget budget = generous();
  budget.min_free_bytes = kFloor;
  auto folder = open_folder(tmp.path(), facts(), budget);
  ASSERT_TRUE(folder);
  std::uint64_t capacity = std::uint64_t{1} << 40;
  std::size_t most_rows_per_image = 0;
  disk.say_free([&] {  // asked for between one set's end and the next one's
    const std::size_t images = 2 * folder->sets();
    if (images > 0) {
      most_rows_per_image = std::max(most_rows_per_image, (rows_in(tmp) + images - 1) / images);
    }
    return capacity - RingOnADisk::kSet * folder->sets();
  });
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(i)));
  capacity = kFloor + 4 * RingOnADisk::kSet + kBlock;
  int i = 20;
  while (i < 40 && !writes(*folder, kStart + seconds(i))) ++i;
  EXPECT_EQ(folder->sets(), 4U);
  EXPECT_LE(most_rows_per_image, 2U);
}

TEST(RecordingFolder, ARestartForgetsTheRowsOfDeletedSetsToo) {
  const TemporaryFolder tmp;
  RecordingBudget budget = generous();
  for (int run = 0; run < 10; ++run) {
    budget.keep = seconds(1);
    auto folder = open_folder(tmp.path(), facts(), budget);
    ASSERT_TRUE(folder);
    ASSERT_TRUE(writes(*folder, kStart + seconds(run)));
  }
  EXPECT_LE(rows_in(tmp), 6U);
  EXPECT_EQ(images_in(tmp.path()), 4U);
}

TEST(RecordingFolder, ImagesThatAKillLeftWithoutARowDoNotHoldUpTheForgettingOfOthers) {
  const TemporaryFolder tmp;
  RecordingBudget budget = generous();
  {
    auto folder = open_folder(tmp.path(), facts(), budget);
    ASSERT_TRUE(folder);
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(i)));
  }
  for (int i = 1; i <= 20; ++i) {
    const Stamp stamp = kStart + seconds(9) + std::chrono::milliseconds(10 * i);
    tmp.write(fmt::format("cam0/{}.pgm", stamp.count()), image_bytes());
  }
  budget.keep = std::chrono::milliseconds(3500);
  auto folder = open_folder(tmp.path(), facts(), budget);
  ASSERT_TRUE(folder);
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(writes(*folder, kStart + seconds(10) + std::chrono::milliseconds(10 * i)));
  }
  constexpr std::size_t kListed = 2 * (3 + 10);  // images of 7 … 9, and those from 10 on
  EXPECT_EQ(images_in(tmp.path()), kListed + 20);
  EXPECT_LE(rows_in(tmp), 2 * kListed);
}

TEST(RecordingFolder, AFullDiskLeavesWholeSetsOnly) {
  const TemporaryFolder tmp;
  auto folder = open_folder(tmp.path(), facts(), generous());
  ASSERT_TRUE(folder);
  ASSERT_TRUE(writes(*folder, kStart));
  std::optional<test::FullDisk> full(1000);
  const auto refused = folder->write_set(set_at(kStart + seconds(1)));
  full.reset();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::io);
  EXPECT_EQ(images_in(tmp.path()), 2U);
  for (const auto& entry : std::filesystem::directory_iterator(tmp.path() / "cam0")) {
    EXPECT_EQ(entry.path().extension(), ".pgm") << entry.path();
  }
  EXPECT_TRUE(writes(*folder, kStart + seconds(2)));  // there is room again
}

TEST(RecordingFolder, ARowThatTheDiskTookInPartIsTakenBack) {
  const TemporaryFolder tmp;
  auto folder = open_folder(tmp.path(), facts(), generous());
  ASSERT_TRUE(folder);
  int sets = 0;
  while (tmp.read("frames.csv").size() <= image_bytes().size()) {
    ASSERT_TRUE(writes(*folder, kStart + seconds(sets++)));
  }
  const std::string before = tmp.read("frames.csv");
  std::optional<test::FullDisk> full(before.size() + 20);
  const auto refused = folder->write_set(set_at(kStart + seconds(sets)));
  full.reset();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("frames.csv"));
  EXPECT_EQ(tmp.read("frames.csv"), before);
  EXPECT_EQ(images_in(tmp.path()), 2 * static_cast<std::size_t>(sets));
}

TEST(RecordingFolder, ARowThatAPowerCutLeftInPartIsTakenBack) {
  const TemporaryFolder tmp;
  ASSERT_TRUE(open_folder(tmp.path(), facts(), generous())->write_set(set_at(kStart)));
  const std::string whole = tmp.read("frames.csv");
  tmp.write("frames.csv", whole + "cam0,18000000");
  tmp.write(".frames.csv.k7Dq2x", "the table as it was to be");
  auto folder = open_folder(tmp.path(), facts(), generous());
  ASSERT_TRUE(folder) << folder.error().message;
  EXPECT_EQ(tmp.read("frames.csv"), whole);
  EXPECT_FALSE(std::filesystem::exists(tmp.path() / ".frames.csv.k7Dq2x"));
}

TEST(RecordingFolder, GoesOnWhereItWasAfterARestart) {
  const TemporaryFolder tmp;
  RecordingBudget budget = generous();
  budget.max_bytes = bytes_of(4);
  {
    auto folder = open_folder(tmp.path(), facts(), budget);
    ASSERT_TRUE(folder);
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(i)));
  }
  tmp.write("cam0/.1800000000000000003.pgm.part", "half an ima");
  auto folder = open_folder(tmp.path(), facts(), budget);
  ASSERT_TRUE(folder) << folder.error().message;
  EXPECT_EQ(folder->sets(), 3U);
  EXPECT_EQ(folder->bytes(), 3 * test::set_bytes() + tmp.read("frames.csv").size());
  EXPECT_FALSE(std::filesystem::exists(tmp.path() / "cam0/.1800000000000000003.pgm.part"));
  for (int i = 3; i < 8; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(i)));
  EXPECT_EQ(images_in(tmp.path()), 8U);
}

TEST(RecordingFolder, GoesOnWhereAKillLeftItInItsFirstMoment) {
  const TemporaryFolder tmp;
  tmp.write("a/.capture.toml.k7Dq2x", "clock = ");
  ASSERT_TRUE(open_folder(tmp.path() / "a", facts(), generous()));
  std::filesystem::remove(tmp.path() / "a/rig.yaml");
  std::filesystem::remove(tmp.path() / "a/markers.toml");
  auto folder = open_folder(tmp.path() / "a", facts(), generous());
  ASSERT_TRUE(folder) << folder.error().message;
  ASSERT_TRUE(writes(*folder, kStart));
  EXPECT_EQ(images_in(tmp.path() / "a"), 2U);
}

TEST(RecordingFolder, NeverWritesIntoSomethingElse) {
  const TemporaryFolder tmp;
  tmp.write("holiday.jpg", "x");
  const auto foreign = open_folder(tmp.path(), facts(), generous());
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().kind, ErrorKind::cant_create);
  const TemporaryFolder other_rig;
  other_rig.write("rig.yaml", tiny_rig_yaml(1));
  EXPECT_FALSE(open_folder(other_rig.path(), facts(), generous()));
  EXPECT_EQ(other_rig.read("rig.yaml"), tiny_rig_yaml(1));
  const auto file = tmp.write("file", "x");
  EXPECT_FALSE(open_folder(file, facts(), generous()));
}

}  // namespace
}  // namespace waymark
