#include "core/base/output_check.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

TEST(OutputCheck, SaysBeforeLongWorkWhatCannotBeWritten) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(check_writable(folder.path() / "new.map"));
  EXPECT_EQ(check_writable(folder.path()).error().kind, ErrorKind::cant_create);
  EXPECT_EQ(check_writable(folder.path() / "absent/new.map").error().kind, ErrorKind::cant_create);
  std::filesystem::create_symlink("loop", folder.path() / "loop");
  EXPECT_EQ(check_writable(folder.path() / "loop/new.map").error().kind, ErrorKind::cant_create);
}

TEST(OutputCheck, AnInputIsSparedByAnyOfItsNames) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("a.map", "x");
  std::filesystem::create_symlink("a.map", folder.path() / "link");
  std::filesystem::create_hard_link(file, folder.path() / "hard");
  std::filesystem::create_directory(folder.path() / "sub");
  for (const char* name : {"a.map", "./a.map", "sub/../a.map", "link", "hard"}) {
    const auto spares = check_spares(folder.path() / name, {"elsewhere", file}, "name another");
    ASSERT_FALSE(spares) << name;
    EXPECT_EQ(spares.error().kind, ErrorKind::usage);
    EXPECT_NE(spares.error().message.find("name another"), std::string::npos);
  }
  EXPECT_TRUE(check_spares(folder.path() / "b.map", {file}));
}

TEST(OutputCheck, NoTwoOutputsAreOneFile) {
  const test::TemporaryFolder folder;
  std::filesystem::create_symlink("a.map", folder.path() / "link");
  const auto path = [&](const char* name) { return folder.path() / name; };
  for (const char* name : {"a.map", "./a.map", "link"}) {
    const auto differ = check_differ({path("a.map"), path("b.tum"), path(name)}, "map and so on");
    ASSERT_FALSE(differ) << name;
    EXPECT_EQ(differ.error().kind, ErrorKind::usage);
    EXPECT_NE(differ.error().message.find("map and so on"), std::string::npos);
  }
  EXPECT_TRUE(check_differ({path("a.map"), path("b.tum"), path("c.yaml")}, ""));
  EXPECT_TRUE(check_differ({}, ""));
}

}  // namespace
}  // namespace waymark
