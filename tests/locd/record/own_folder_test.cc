#include "locd/record/own_folder.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/mount_namespace.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A folder of locd's with one image, and a place outside with another.
class OwnFolderTest : public testing::Test {
 protected:
  OwnFolderTest() {
    tmp_.write("own/1.pgm", std::string(5000, 'i'));
    tmp_.write("outside/2.pgm", "theirs");
  }
  [[nodiscard]] OwnFolder own() const { return *OwnFolder::open(tmp_.path() / "own"); }
  /// Neither counted nor deleted, for that reason.
  void expect_kept(const std::string& name, const std::string& why) const {
    const auto bytes = own().own_bytes(name);
    ASSERT_FALSE(bytes) << name;
    EXPECT_EQ(bytes.error().kind, ErrorKind::permission);
    EXPECT_THAT(bytes.error().message, HasSubstr(why));
    EXPECT_FALSE(own().remove(name));
    EXPECT_TRUE(fs::exists(fs::symlink_status(tmp_.path() / "own" / name))) << name;
  }

  TemporaryFolder tmp_;
};

TEST_F(OwnFolderTest, AFileOfItsOwnIsWorthItsBlocksAndCanBeDeleted) {
  const auto bytes = own().own_bytes("1.pgm");
  ASSERT_TRUE(bytes);
  EXPECT_GE(*bytes, 5000U);
  EXPECT_EQ(*bytes % 512, 0U);
  const auto removed = own().remove("1.pgm");
  ASSERT_TRUE(removed);
  EXPECT_EQ(*removed, *bytes);
  EXPECT_EQ(own().remove("1.pgm").error().kind, ErrorKind::no_input);
}

TEST_F(OwnFolderTest, ASparseFileIsWorthWhatItTakes) {
  fs::resize_file(tmp_.write("own/sparse.pgm", ""), std::uintmax_t{5} << 30);
  EXPECT_LT(*own().own_bytes("sparse.pgm"), 1U << 20);
}

TEST_F(OwnFolderTest, LinksFoldersAndPipesAreNotItsOwn) {
  fs::create_symlink("../outside/2.pgm", tmp_.path() / "own/link");
  fs::create_directory_symlink("../outside", tmp_.path() / "own/folder_link");
  fs::create_directory(tmp_.path() / "own/folder");
  ASSERT_EQ(::mkfifo((tmp_.path() / "own/pipe").c_str(), 0600), 0);
  expect_kept("link", "it is a link");
  expect_kept("folder_link", "it is a link");
  expect_kept("folder", "no regular file");
  expect_kept("pipe", "no regular file");
  EXPECT_EQ(tmp_.read("outside/2.pgm"), "theirs");
}

TEST_F(OwnFolderTest, AFileOfTwoNamesIsNot) {
  fs::create_hard_link(tmp_.path() / "own/1.pgm", tmp_.path() / "outside/backup.pgm");
  expect_kept("1.pgm", "it has 2 names");
}

TEST_F(OwnFolderTest, AnotherUsersFileIsNot) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root gives files away";
  ASSERT_EQ(::chown((tmp_.path() / "own/1.pgm").c_str(), 12345, 12345), 0);
  expect_kept("1.pgm", "it belongs to user 12345");
}

TEST_F(OwnFolderTest, OnADiskWithoutOwnersItsOwnAreThoseOfWhatItHasMade) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root gives files away";
  ASSERT_EQ(::chown(tmp_.write("own/made", "").c_str(), 12345, 12345), 0);
  ASSERT_EQ(::chown((tmp_.path() / "own/1.pgm").c_str(), 12345, 12345), 0);
  OwnFolder folder = own();
  folder.learn_owner("made");
  EXPECT_TRUE(folder.remove("1.pgm"));
}

TEST_F(OwnFolderTest, WhatIsMountedInItIsNot) {
  if (!test::enter_mount_namespace()) GTEST_SKIP() << "no mount namespace here";
  tmp_.write("own/mounted.pgm", "");
  fs::create_directory(tmp_.path() / "own/cam0");
  const test::BindMount file(tmp_.path() / "outside/2.pgm", tmp_.path() / "own/mounted.pgm");
  const test::BindMount folder(tmp_.path() / "outside", tmp_.path() / "own/cam0");
  ASSERT_TRUE(file.is_there() && folder.is_there());
  expect_kept("mounted.pgm", "mounted");
  const auto refused = own().folder("cam0");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("something is mounted there"));
  EXPECT_FALSE(own().make_folder("cam0"));
}

TEST_F(OwnFolderTest, ItMayLieWhereSomethingIsMountedItself) {
  if (!test::enter_mount_namespace()) GTEST_SKIP() << "no mount namespace here";
  const test::BindMount disk(tmp_.path() / "outside", tmp_.path() / "own");
  ASSERT_TRUE(disk.is_there());
  EXPECT_TRUE(own().remove("2.pgm"));
}

TEST_F(OwnFolderTest, LeadsIntoFoldersNeverOverLinksOrUpwards) {
  fs::create_directory_symlink("../outside", tmp_.path() / "own/cam0");
  EXPECT_THAT(own().folder("cam0").error().message, HasSubstr("it is a link"));
  EXPECT_THAT(own().make_folder("cam0").error().message, HasSubstr("it is a link"));
  EXPECT_THAT(own().folder("1.pgm").error().message, HasSubstr("it is no folder"));
  EXPECT_FALSE(own().folder(".."));
  EXPECT_TRUE(own().make_folder("cam1"));
  EXPECT_TRUE(own().folder("cam1"));
}

TEST_F(OwnFolderTest, StaysTheSameFolderWhateverIsPutInItsPlace) {
  const OwnFolder folder = own();
  fs::rename(tmp_.path() / "own", tmp_.path() / "elsewhere");
  fs::create_directory_symlink("outside", tmp_.path() / "own");
  EXPECT_FALSE(folder.remove("2.pgm"));
  EXPECT_TRUE(folder.remove("1.pgm"));
  EXPECT_EQ(tmp_.read("outside/2.pgm"), "theirs");
}

TEST_F(OwnFolderTest, AppendsToItsOwnFilesOnlyAndWaitsForNobody) {
  fs::create_symlink("../outside/2.pgm", tmp_.path() / "own/link");
  ASSERT_EQ(::mkfifo((tmp_.path() / "own/pipe").c_str(), 0600), 0);
  fs::create_hard_link(tmp_.path() / "outside/2.pgm", tmp_.path() / "own/second_name");
  for (const char* name : {"link", "pipe", "second_name"}) {
    const auto refused = own().open_to_append(name);
    ASSERT_FALSE(refused) << name;
    EXPECT_EQ(refused.error().kind, ErrorKind::cant_create);
    EXPECT_FALSE(own().check_writable(name)) << name;
  }
  const Descriptor reader(::open((tmp_.path() / "own/pipe").c_str(), O_RDONLY | O_NONBLOCK));
  EXPECT_FALSE(own().open_to_append("pipe"));  // though somebody reads it
  EXPECT_TRUE(own().open_to_append("1.pgm"));
  EXPECT_TRUE(own().open_to_append("new"));
  EXPECT_TRUE(own().check_writable("absent"));
}

TEST_F(OwnFolderTest, NeverWritesIntoWhatIsThere) {
  fs::create_symlink("../outside/new", tmp_.path() / "own/link");
  EXPECT_FALSE(own().create("link").valid());
  EXPECT_FALSE(own().create("1.pgm").valid());
  EXPECT_TRUE(own().create("3.pgm").valid());
  EXPECT_FALSE(fs::exists(tmp_.path() / "outside/new"));
}

}  // namespace
}  // namespace waymark
