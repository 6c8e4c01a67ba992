// What goes for its date, and what one set may have deleted: clocks are wrong more often than
// disks.
#include "tests/locd/record/recording_fixture.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::bytes_of;
using test::facts;
using test::generous;
using test::images_in;
using test::kStart;
using test::open_folder;
using test::writes;

constexpr Stamp kIn1970 = seconds(100);
constexpr Stamp kIn2035 = seconds(2'060'000'000);

/// Recordings of an archive, made one after the other by clocks of all kinds.
class Dates : public testing::Test {
 protected:
  /// `sets` of a recording, a second apart; `known`: the system vouches for the clock.
  void record(const std::string& name, Stamp start, int sets, bool known) {
    auto folder = open(name, known);
    ASSERT_TRUE(folder) << folder.error().message;
    for (int i = 0; i < sets; ++i) ASSERT_TRUE(writes(*folder, start + seconds(i)));
    ASSERT_TRUE(folder->sync());
  }
  [[nodiscard]] Expected<RecordingFolder> open(const std::string& name, bool known) const {
    RecordingFacts with_archive = facts();
    with_archive.archive = archive_.path();
    with_archive.date_known = known;
    return open_folder(archive_.path() / name, with_archive, budget_);
  }
  [[nodiscard]] std::size_t images(const std::string& name) const {
    return std::filesystem::exists(archive_.path() / name / "cam0")
               ? images_in(archive_.path() / name)
               : 0;
  }

  TemporaryFolder archive_;
  RecordingBudget budget_ = generous();  // keeps for 100 hours
};

TEST_F(Dates, ARoundOf1970IsNotOldOnceTheClockIsRight) {
  record("1970", kIn1970, 5, false);
  record("now", kStart, 20, true);
  EXPECT_EQ(images("1970"), 10U);
}

TEST_F(Dates, AClockInTheFutureMakesNothingOld) {
  for (int r = 0; r < 5; ++r) record(std::to_string(r), kStart + hours(r), 3, true);
  record("future", kIn2035, 30, false);
  for (int r = 0; r < 5; ++r) EXPECT_EQ(images(std::to_string(r)), 6U) << r;
}

TEST_F(Dates, NorIsOldWhatItRecordedItselfBefore) {
  record("ring", kStart, 30, true);
  record("ring", kIn2035, 5, false);
  EXPECT_EQ(images("ring"), 70U);
  record("ring", kStart + hours(1), 5, true);
  EXPECT_EQ(images("ring"), 80U);
}

TEST_F(Dates, AFolderWithUndatedSetsStaysUndatedWhoeverGoesOnWithIt) {
  record("ring", kIn1970, 5, false);
  record("ring", kStart, 5, true);
  EXPECT_THAT(archive_.read("ring/capture.toml"), testing::HasSubstr("date_known = false"));
  record("ring", kStart + hours(1), 20, true);
  EXPECT_EQ(images("ring"), 60U);
}

TEST_F(Dates, WhatIsSurelyOldGoesTwoSetsWithEachThatComes) {
  record("old", kStart, 10, true);
  auto folder = open("new", true);
  ASSERT_TRUE(folder);
  const Stamp later = kStart + hours(200);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(images("old"), 2 * static_cast<std::size_t>(std::max(0, 10 - 2 * i))) << i;
    ASSERT_TRUE(writes(*folder, later + milliseconds(100 * i)));
  }
  EXPECT_FALSE(std::filesystem::exists(archive_.path() / "old"));
}

TEST_F(Dates, WhatIsNotOldYetStaysOfARecordingThatIsHalfOld) {
  record("old", kStart, 10, true);
  auto folder = open("new", true);
  ASSERT_TRUE(folder);
  const Stamp later = kStart + budget_.keep + milliseconds(3500);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(writes(*folder, later + milliseconds(10 * i)));
  EXPECT_EQ(images("old"), 12U);  // of 4 … 9; 0 … 3 are gone
}

TEST_F(Dates, AClockThatIsVouchedForLaterIsASoundOneFromThenOn) {
  record("old", kStart, 4, true);
  auto folder = open("new", false);
  ASSERT_TRUE(folder);
  const Stamp later = kStart + hours(200);
  ASSERT_TRUE(writes(*folder, later));
  ASSERT_TRUE(folder->sync());
  EXPECT_EQ(images("old"), 8U);
  EXPECT_THAT(archive_.read("new/capture.toml"), testing::HasSubstr("date_known = false"));
  folder->set_date_known(true);
  ASSERT_TRUE(writes(*folder, later + seconds(1)));
  ASSERT_TRUE(folder->sync());
  EXPECT_EQ(images("old"), 4U);
  EXPECT_THAT(archive_.read("new/capture.toml"), testing::HasSubstr("date_known = true"));
}

TEST_F(Dates, OneRunsOwnSetsAreOfOneClockAndGoWhateverItSays) {
  budget_.keep = seconds(5);
  record("1970", kIn1970, 25, false);
  EXPECT_EQ(images("1970"), 12U);  // of 19 … 24
}

TEST_F(Dates, UndatedRecordingsDoNotHideDatedOnesThatAreOld) {
  record("1970", kIn1970, 3, false);
  record("old", kStart, 3, true);
  record("now", kStart + hours(200), 5, true);
  EXPECT_EQ(images("1970"), 6U);
  EXPECT_EQ(images("old"), 0U);
}

TEST_F(Dates, ABudgetThatWasLoweredCostsTwoSetsPerSetToo) {
  record("old", kStart, 10, true);
  budget_.max_bytes = bytes_of(3);
  auto folder = open("new", false);
  ASSERT_TRUE(folder);
  std::size_t before = images("old");
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(writes(*folder, kStart + hours(1) + seconds(i)));
    const std::size_t now = images("old");
    EXPECT_LE(before - now, 4U) << "with set " << i;
    before = now;
  }
  EXPECT_EQ(before, 0U);
  EXPECT_LE(folder->bytes(), budget_.max_bytes);
}

}  // namespace
}  // namespace waymark
