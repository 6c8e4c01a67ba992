#include "core/base/growing_folder.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(GrowingFolder, AppearsWhole) {
  const TemporaryFolder tmp;
  const fs::path place = tmp.path() / "room/";
  auto folder = GrowingFolder::begin(place);
  ASSERT_TRUE(folder);
  ASSERT_TRUE(create_folder(folder->path() / "cam0"));
  ASSERT_TRUE(write_new_file(folder->path() / "cam0/1.pgm", "pixels"));
  EXPECT_FALSE(fs::exists(place));
  ASSERT_TRUE(folder->finish());
  EXPECT_EQ(tmp.read("room/cam0/1.pgm"), "pixels");
  EXPECT_EQ(entries(tmp.path()), 1U);
}

TEST(GrowingFolder, LeavesNothingWhereItIsNotFinished) {
  const TemporaryFolder tmp;
  {
    auto folder = GrowingFolder::begin(tmp.path() / "room");
    ASSERT_TRUE(folder);
    ASSERT_TRUE(write_new_file(folder->path() / "a", "text"));
    const GrowingFolder moved(std::move(*folder));
  }
  EXPECT_EQ(entries(tmp.path()), 0U);
}

TEST(GrowingFolder, TakesNoOthersPlace) {
  const TemporaryFolder tmp;
  tmp.write("room/mine", "text");
  const auto taken = GrowingFolder::begin(tmp.path() / "room");
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().kind, ErrorKind::cant_create);
  EXPECT_FALSE(GrowingFolder::begin(tmp.path() / "no/such/room"));
  auto folder = GrowingFolder::begin(tmp.path() / "hall");
  ASSERT_TRUE(folder);
  tmp.write("hall/mine", "text");  // while it grew
  const auto finished = folder->finish();
  ASSERT_FALSE(finished);
  EXPECT_EQ(tmp.read("hall/mine"), "text");
}

TEST(WriteNewFile, ReplacesNothing) {
  const TemporaryFolder tmp;
  tmp.write("a", "earlier");
  EXPECT_FALSE(write_new_file(tmp.path() / "a", "later"));
  EXPECT_EQ(tmp.read("a"), "earlier");
}

}  // namespace
}  // namespace waymark
