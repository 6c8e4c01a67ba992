#include "locd/recording_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "core/capture/capture_folder.h"
#include "core/capture/image_file.h"
#include "core/capture/pgm.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

using std::chrono::seconds;
using testing::HasSubstr;

constexpr Stamp kStart = seconds(1'800'000'000);

RecordingFacts facts() {
  RecordingFacts f;
  f.rig_yaml = tiny_rig_yaml(2);
  f.markers_toml = tiny_markers_toml();
  f.session_id = "0123456789abcdef";
  f.version = "0.1.0";
  f.codec = "pgm";
  f.cameras = {"cam0", "cam1"};
  f.sync_tolerance = std::chrono::milliseconds(5);
  return f;
}

RecordingBudget generous() { return {std::uint64_t{1} << 40, std::chrono::hours(100), 0}; }

const std::string& image_bytes() {
  static const std::string bytes = encode_pgm(GrayImage(64, 48, 7).view());
  return bytes;
}

std::vector<RecordedImage> set_at(Stamp stamp) {
  std::vector<RecordedImage> images(2);
  for (std::size_t c = 0; c < 2; ++c) {
    images[c].camera = c;
    images[c].info.stamp = stamp + std::chrono::microseconds(c);
    images[c].info.sequence = 42;
    images[c].info.exposure = std::chrono::microseconds(250);
    images[c].bytes = image_bytes();
  }
  return images;
}

/// Images in the capture as its readers see it.
std::size_t images_in(const std::filesystem::path& path) {
  const auto capture = open_capture_folder(path);
  EXPECT_TRUE(capture) << capture.error().message;
  if (!capture) return 0;
  for (const ImageFile& file : capture->images) EXPECT_TRUE(read_gray_image(file.path));
  return capture->images.size();
}

TEST(RecordingFolder, IsACaptureFromTheFirstSetOn) {
  const TemporaryFolder tmp;
  auto folder = RecordingFolder::open(tmp.path() / "a" / "b", facts(), generous());
  ASSERT_TRUE(folder) << folder.error().message;
  ASSERT_TRUE(folder->write_set(set_at(kStart)));
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
  EXPECT_EQ(folder->bytes(), 2 * image_bytes().size());
}

TEST(RecordingFolder, IsARingByBytes) {
  const TemporaryFolder tmp;
  RecordingBudget budget = generous();
  budget.max_bytes = 10 * 2 * image_bytes().size();
  auto folder = RecordingFolder::open(tmp.path(), facts(), budget);
  ASSERT_TRUE(folder);
  for (int i = 0; i < 25; ++i) ASSERT_TRUE(folder->write_set(set_at(kStart + seconds(i))));
  EXPECT_EQ(folder->sets(), 10U);
  EXPECT_EQ(images_in(tmp.path()), 20U);
  EXPECT_EQ(open_capture_folder(tmp.path())->images.front().stamp, kStart + seconds(15));
}

TEST(RecordingFolder, IsARingByAge) {
  const TemporaryFolder tmp;
  RecordingBudget budget = generous();
  budget.keep = seconds(5);
  auto folder = RecordingFolder::open(tmp.path(), facts(), budget);
  ASSERT_TRUE(folder);
  for (int i = 0; i < 25; ++i) ASSERT_TRUE(folder->write_set(set_at(kStart + seconds(i))));
  EXPECT_EQ(folder->sets(), 6U);  // 19 … 24
  EXPECT_EQ(images_in(tmp.path()), 12U);
}

TEST(RecordingFolder, TheFloorOfFreeSpaceHolds) {
  const TemporaryFolder tmp;
  auto folder = RecordingFolder::open(tmp.path(), facts(), generous());
  ASSERT_TRUE(folder);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(folder->write_set(set_at(kStart + seconds(i))));
  RecordingBudget more_than_any_disk = generous();
  more_than_any_disk.min_free_bytes = std::uint64_t{1} << 60;
  folder->set_budget(more_than_any_disk);
  const auto refused = folder->write_set(set_at(kStart + seconds(3)));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::io);
  EXPECT_THAT(refused.error().message, HasSubstr("min_free_bytes"));
  EXPECT_EQ(folder->sets(), 0U);  // the ring gave all it had before giving up
  EXPECT_EQ(folder->bytes(), 0U);
}

TEST(RecordingFolder, AFullDiskLeavesWholeSetsOnly) {
  const TemporaryFolder tmp;
  auto folder = RecordingFolder::open(tmp.path(), facts(), generous());
  ASSERT_TRUE(folder);
  ASSERT_TRUE(folder->write_set(set_at(kStart)));
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit full{1000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &full);
  const auto refused = folder->write_set(set_at(kStart + seconds(1)));
  ::setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::io);
  EXPECT_EQ(images_in(tmp.path()), 2U);
  for (const auto& entry : std::filesystem::directory_iterator(tmp.path() / "cam0")) {
    EXPECT_EQ(entry.path().extension(), ".pgm") << entry.path();
  }
  EXPECT_TRUE(folder->write_set(set_at(kStart + seconds(2))));  // there is room again
}

TEST(RecordingFolder, GoesOnWhereItWasAfterARestart) {
  const TemporaryFolder tmp;
  RecordingBudget budget = generous();
  budget.max_bytes = 4 * 2 * image_bytes().size();
  {
    auto folder = RecordingFolder::open(tmp.path(), facts(), budget);
    ASSERT_TRUE(folder);
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(folder->write_set(set_at(kStart + seconds(i))));
  }
  tmp.write("cam0/.1800000000000000003.pgm.part", "half an ima");
  auto folder = RecordingFolder::open(tmp.path(), facts(), budget);
  ASSERT_TRUE(folder) << folder.error().message;
  EXPECT_EQ(folder->sets(), 3U);
  EXPECT_EQ(folder->bytes(), 3 * 2 * image_bytes().size());
  EXPECT_FALSE(std::filesystem::exists(tmp.path() / "cam0/.1800000000000000003.pgm.part"));
  for (int i = 3; i < 8; ++i) ASSERT_TRUE(folder->write_set(set_at(kStart + seconds(i))));
  EXPECT_EQ(images_in(tmp.path()), 8U);
}

TEST(RecordingFolder, NeverWritesIntoSomethingElse) {
  const TemporaryFolder tmp;
  tmp.write("holiday.jpg", "x");
  const auto foreign = RecordingFolder::open(tmp.path(), facts(), generous());
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().kind, ErrorKind::cant_create);
  const TemporaryFolder other_rig;
  other_rig.write("rig.yaml", tiny_rig_yaml(1));
  EXPECT_FALSE(RecordingFolder::open(other_rig.path(), facts(), generous()));
  EXPECT_EQ(other_rig.read("rig.yaml"), tiny_rig_yaml(1));
  const auto file = tmp.write("file", "x");
  EXPECT_FALSE(RecordingFolder::open(file, facts(), generous()));
}

TEST(RecordingFolder, EarlierRecordingsShareTheBudgetAndGoFirst) {
  const TemporaryFolder archive;
  RecordingFacts with_archive = facts();
  with_archive.archive = archive.path();
  RecordingBudget budget = generous();
  for (int r = 0; r < 2; ++r) {
    auto earlier = RecordingFolder::open(archive.path() / std::to_string(r), with_archive, budget);
    ASSERT_TRUE(earlier);
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(earlier->write_set(set_at(kStart + seconds(100 * r + i))));
    }
  }
  archive.write("notes/readme.txt", "not a recording");
  budget.max_bytes = 8 * 2 * image_bytes().size();
  auto folder = RecordingFolder::open(archive.path() / "2", with_archive, budget);
  ASSERT_TRUE(folder);
  ASSERT_TRUE(folder->write_set(set_at(kStart + seconds(200))));
  EXPECT_TRUE(std::filesystem::exists(archive.path() / "0"));
  for (int i = 1; i < 4; ++i) ASSERT_TRUE(folder->write_set(set_at(kStart + seconds(200 + i))));
  EXPECT_FALSE(std::filesystem::exists(archive.path() / "0"));  // the texts count as well
  EXPECT_TRUE(std::filesystem::exists(archive.path() / "1"));
  EXPECT_TRUE(std::filesystem::exists(archive.path() / "notes/readme.txt"));
  for (int i = 4; i < 12; ++i) ASSERT_TRUE(folder->write_set(set_at(kStart + seconds(200 + i))));
  EXPECT_FALSE(std::filesystem::exists(archive.path() / "1"));
  EXPECT_EQ(folder->sets(), 8U);
}

}  // namespace
}  // namespace waymark
