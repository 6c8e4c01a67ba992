// Recordings that share a budget: what goes first, what never goes.
#include "tests/locd/record/recording_fixture.h"
#include "tests/support/as_nobody.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using std::chrono::seconds;
using test::bytes_of;
using test::facts;
using test::generous;
using test::image_bytes;
using test::kStart;
using test::open_folder;
using test::set_at;
using test::writes;

TEST(RecordingFolder, EarlierRecordingsShareTheBudgetAndGoFirst) {
  const TemporaryFolder archive;
  RecordingFacts with_archive = facts();
  with_archive.archive = archive.path();
  RecordingBudget budget = generous();
  for (int r = 0; r < 2; ++r) {
    auto earlier = open_folder(archive.path() / std::to_string(r), with_archive, budget);
    ASSERT_TRUE(earlier);
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(writes(*earlier, kStart + seconds(100 * r + i)));
    }
  }
  archive.write("notes/readme.txt", "not a recording");
  budget.max_bytes = bytes_of(8);
  auto folder = open_folder(archive.path() / "2", with_archive, budget);
  ASSERT_TRUE(folder);
  ASSERT_TRUE(writes(*folder, kStart + seconds(200)));
  EXPECT_TRUE(std::filesystem::exists(archive.path() / "0"));
  for (int i = 1; i < 4; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(200 + i)));
  EXPECT_FALSE(std::filesystem::exists(archive.path() / "0"));  // the texts count as well
  EXPECT_TRUE(std::filesystem::exists(archive.path() / "1"));
  EXPECT_TRUE(std::filesystem::exists(archive.path() / "notes/readme.txt"));
  for (int i = 4; i < 12; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(200 + i)));
  EXPECT_FALSE(std::filesystem::exists(archive.path() / "1"));
  EXPECT_EQ(folder->sets(), 8U);
}

TEST(CheckArchive, SaysBeforeTheFirstRecordingWhatIsNoFolder) {
  const TemporaryFolder folder;
  const auto path = [&](const char* name) { return folder.path() / name; };
  folder.write("file", "");
  std::filesystem::create_symlink("absent", path("nowhere"));
  std::filesystem::create_symlink("loop", path("loop"));
  std::filesystem::create_directory_symlink(".", path("here"));
  const std::string long_name(300, 'x');
  for (const auto& wrong :
       {std::filesystem::path("/dev/zero"), std::filesystem::path("/dev/null/a"), path("file"),
        path("file/a/b"), path("nowhere"), path("nowhere/a"), path("loop"), path("loop/a"),
        folder.path() / long_name}) {
    const auto checked = check_archive(wrong);
    ASSERT_FALSE(checked) << wrong;
    EXPECT_EQ(checked.error().kind, ErrorKind::config) << wrong;
  }
  for (const char* right : {"", "a", "a/b/c", "a/", "here", "here/a", "."}) {
    const auto checked = check_archive(path(right));
    ASSERT_TRUE(checked) << checked.error().message;
    EXPECT_FALSE(checked->has_value()) << right;
  }
  EXPECT_FALSE(std::filesystem::exists(path("a"))) << "nothing is made";
}

TEST(CheckArchive, AFolderThatThisUserMayNotWriteToIsNoted) {
  const test::AsNobody nobody;
  if (!nobody.applies()) GTEST_SKIP() << "the superuser may write everywhere";
  const auto checked = check_archive("/proc/recordings");
  ASSERT_TRUE(checked) << checked.error().message;
  EXPECT_TRUE(checked->has_value());
}

TEST(RecordingFolder, WhatLocdDidNotRecordStays) {
  const TemporaryFolder archive;
  RecordingFacts with_archive = facts();
  with_archive.archive = archive.path();
  const TemporaryFolder elsewhere;
  for (const auto& [name, software] : {std::pair{"bought", "waymark simulator"},
                                       std::pair{"theirs", "their recorder"},
                                       {"unsaid", ""}}) {
    const std::string folder = name;
    archive.write(folder + "/rig.yaml", tiny_rig_yaml(2));
    archive.write(folder + "/cam0/1.pgm", image_bytes());
    if (software[0] != '\0') {
      archive.write(folder + "/capture.toml", fmt::format("software = \"{}\"\n", software));
    }
  }
  for (const auto& folder : {archive.path() / "ours", elsewhere.path() / "linked"}) {
    ASSERT_TRUE(open_folder(folder, facts(), generous())->write_set(set_at(kStart)));
  }
  std::filesystem::create_directory_symlink(elsewhere.path() / "linked", archive.path() / "link");
  RecordingBudget budget = generous();
  budget.max_bytes = bytes_of(3);
  auto folder = open_folder(archive.path() / "new", with_archive, budget);
  ASSERT_TRUE(folder);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(writes(*folder, kStart + seconds(100 + i)));
  for (const char* name : {"bought", "theirs", "unsaid", "link"}) {
    EXPECT_TRUE(std::filesystem::exists(archive.path() / name / "rig.yaml")) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(archive.path() / "ours"));
}

TEST(RecordingFolder, ACaptureOfTheSameRigThatLocdDidNotRecordIsNotGoneOnWith) {
  const TemporaryFolder tmp;
  tmp.write("rig.yaml", facts().rig_yaml);
  tmp.write("capture.toml", "software = \"their recorder\"\n");
  const auto refused = open_folder(tmp.path(), facts(), generous());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::cant_create);
}

}  // namespace
}  // namespace waymark
