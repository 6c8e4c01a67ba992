#include "locd/record/recording_on_disk.h"

#include "tests/locd/record/recording_fixture.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::facts;
using test::kStart;
using testing::HasSubstr;

constexpr Stamp kTolerance = milliseconds(5);
const std::atomic<bool> kNotEnough{false};

/// A recording of three sets of two images in an archive.
class RecordingOnDiskTest : public testing::Test {
 protected:
  RecordingOnDiskTest() {
    auto folder = test::open_folder(tmp_.path() / "one", facts(), test::generous());
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(test::writes(*folder, kStart + seconds(i)));
  }
  [[nodiscard]] OwnFolder archive() const { return *OwnFolder::open(tmp_.path()); }
  [[nodiscard]] RecordingOnDisk weighed() const {
    auto recording = *RecordingOnDisk::find(archive(), "one");
    recording.weigh(kTolerance, kNotEnough);
    recording.close();
    return recording;
  }

  TemporaryFolder tmp_;
};

TEST_F(RecordingOnDiskTest, KnowsItsImagesSetsAndDates) {
  const RecordingOnDisk recording = weighed();
  EXPECT_EQ(recording.images(), 6U);
  EXPECT_EQ(recording.sets(), 3U);
  EXPECT_EQ(recording.oldest(), kStart);
  EXPECT_EQ(recording.newest(), kStart + seconds(2) + std::chrono::microseconds(1));
  EXPECT_TRUE(recording.dated());
  EXPECT_GE(recording.bytes(), 3 * test::set_bytes());
  tmp_.write("one/capture.toml", "software = \"waymark locd 0.1\"\ndate_known = false\n");
  EXPECT_FALSE(weighed().dated());
}

TEST_F(RecordingOnDiskTest, IsFoundWhereLocdRecordedOnly) {
  tmp_.write("theirs/capture.toml", "software = \"another\"\n");
  std::filesystem::create_directory_symlink("one", tmp_.path() / "link");
  for (const char* name : {"theirs", "link", "absent"}) {
    EXPECT_FALSE(RecordingOnDisk::find(archive(), name)) << name;
  }
}

TEST_F(RecordingOnDiskTest, GoesSetBySetAndThenAltogether) {
  RecordingOnDisk recording = weighed();
  EXPECT_EQ(recording.delete_oldest_set(), test::set_bytes());
  EXPECT_EQ(recording.images(), 4U);
  EXPECT_EQ(recording.sets(), 2U);
  EXPECT_EQ(recording.oldest(), kStart + seconds(1));
  EXPECT_EQ(test::images_in(tmp_.path() / "one"), 4U);
  EXPECT_EQ(recording.delete_oldest_set(), test::set_bytes());
  EXPECT_GT(recording.delete_oldest_set(), test::set_bytes());  // its texts, too
  EXPECT_EQ(recording.bytes(), 0U);
  EXPECT_FALSE(std::filesystem::exists(tmp_.path() / "one"));
}

TEST_F(RecordingOnDiskTest, WhatCantBeDeletedIsToldOnceAndKeepsItsTexts) {
  const auto image = tmp_.path() / "one/cam0" / (std::to_string(kStart.count()) + ".pgm");
  std::filesystem::create_hard_link(image, tmp_.path() / "backup");
  RecordingOnDisk recording = weighed();
  EXPECT_THAT(recording.take_note(), HasSubstr("1 of its files can't be deleted"));
  EXPECT_EQ(recording.take_note(), "");
  for (int i = 0; i < 3; ++i) recording.delete_oldest_set();
  EXPECT_EQ(recording.bytes(), 0U);
  EXPECT_EQ(test::images_in(tmp_.path() / "one"), 1U);
}

TEST_F(RecordingOnDiskTest, APartOfARecordingLeavesItsTextsAndWhatCameLater) {
  const OwnFolder folder = *archive().folder("one");
  auto part = RecordingOnDisk::earlier_part_of(folder, true);
  part.weigh(kTolerance, kNotEnough);
  EXPECT_EQ(part.bytes(), 3 * test::set_bytes());
  // From a clock that has gone back.
  tmp_.write("one/cam0/5.pgm", test::image_bytes());
  for (int i = 0; i < 3; ++i) part.delete_oldest_set();
  EXPECT_EQ(part.bytes(), 0U);
  EXPECT_EQ(test::images_in(tmp_.path() / "one"), 1U);
}

TEST_F(RecordingOnDiskTest, WeighingEndsWhenItIsEnough) {
  auto recording = *RecordingOnDisk::find(archive(), "one");
  const std::atomic<bool> enough{true};
  recording.weigh(kTolerance, enough);
  EXPECT_EQ(recording.bytes(), 0U);
}

}  // namespace
}  // namespace waymark
