#include "core/base/same_file.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

TEST(SameFile, UnderAnyName) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("a.map", "x");
  fs::create_symlink("a.map", folder.path() / "link");
  fs::create_hard_link(file, folder.path() / "twin");
  fs::create_directory(folder.path() / "sub");
  for (const fs::path& other : {file, folder.path() / "link", folder.path() / "twin",
                                folder.path() / "sub" / ".." / "a.map"}) {
    EXPECT_TRUE(is_same_file(file, other)) << other;
  }
  EXPECT_FALSE(is_same_file(file, folder.write("b.map", "x")));
}

TEST(SameFile, ThatIsNotThereYet) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "sub");
  fs::create_symlink("sub", folder.path() / "way");
  const fs::path absent = folder.path() / "sub" / "a.map";
  EXPECT_TRUE(is_same_file(absent, folder.path() / "way" / "a.map"));
  EXPECT_TRUE(is_same_file(absent, folder.path() / "sub" / "." / "a.map"));
  EXPECT_FALSE(is_same_file(absent, folder.path() / "way" / "b.map"));
}

TEST(SameFile, LinksInCirclesThrowNothing) {
  const TemporaryFolder folder;
  fs::create_symlink("loop", folder.path() / "loop");
  EXPECT_TRUE(is_same_file(folder.path() / "loop", folder.path() / "loop"));
  EXPECT_FALSE(is_same_file(folder.path() / "loop", folder.path() / "a.map"));
  EXPECT_FALSE(is_same_file(folder.path() / "loop" / "a", folder.path() / "loop" / "b"));
}

TEST(IsWithin, FollowsLinksAndTakesWhatIsNotThereYet) {
  const test::TemporaryFolder folder;
  folder.write("sub/deep/a", "x");
  std::filesystem::create_directory_symlink("sub", folder.path() / "way");
  std::filesystem::create_symlink("sub/new", folder.path() / "dangling");
  const auto within = [&](const char* path, const char* in) {
    return is_within(folder.path() / path, folder.path() / in);
  };
  for (const char* path : {"sub/a", "sub/deep/a", "sub/deep/new", "way/new", "dangling"}) {
    EXPECT_TRUE(within(path, "sub")) << path;
    EXPECT_TRUE(within(path, "way")) << path;
  }
  for (const char* path : {"sub", "way", "a", "subway/a", "sub/../a"}) {
    EXPECT_FALSE(within(path, "sub")) << path;
  }
  EXPECT_FALSE(within("a", "absent"));
  EXPECT_FALSE(is_within("/", "/nowhere"));
}

}  // namespace
}  // namespace waymark
