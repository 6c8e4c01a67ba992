#include "core/base/output_check.h"

#include <gtest/gtest.h>

#include "tests/support/as_nobody.h"
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

TEST(OutputCheck, NamesLeaveRoomForWhatIsWrittenBesideThem) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(check_writable(folder.path() / std::string(231, 'x')));
  for (const std::size_t length : {232, 255, 256, 300, 5000}) {
    const std::string name(length, 'x');
    for (const auto& path : {folder.path() / name, std::filesystem::path(name)}) {
      const auto written = check_writable(path);
      ASSERT_FALSE(written) << length;
      EXPECT_EQ(written.error().kind, ErrorKind::cant_create) << length;
    }
  }
}

TEST(OutputCheck, AFolderThatForbidsItIsAPermissionError) {
  const test::TemporaryFolder folder;
  folder.write("closed/sub/a.map", "");
  std::filesystem::permissions(folder.path() / "closed", std::filesystem::perms::none);
  {
    const test::AsNobody nobody;
    for (const char* name : {"closed/a.map", "closed/sub/a.map"}) {
      if (!nobody.applies()) break;
      const auto written = check_writable(folder.path() / name);
      ASSERT_FALSE(written) << name;
      EXPECT_EQ(written.error().kind, ErrorKind::permission) << name;
    }
  }
  std::filesystem::permissions(folder.path() / "closed", std::filesystem::perms::owner_all);
}

TEST(OutputCheck, WhatIsNoFileIsNoPlaceForOne) {
  const test::TemporaryFolder folder;
  std::filesystem::create_symlink("loop", folder.path() / "loop");
  std::filesystem::create_symlink("/dev/null", folder.path() / "device");
  std::filesystem::create_symlink("absent/new.map", folder.path() / "nowhere");
  for (const char* name : {"loop", "device", "nowhere"}) {
    const auto written = check_writable(folder.path() / name);
    ASSERT_FALSE(written) << name;
    EXPECT_EQ(written.error().kind, ErrorKind::cant_create) << name;
  }
  EXPECT_FALSE(check_writable(""));
  std::filesystem::create_symlink("new.map", folder.path() / "link");
  EXPECT_TRUE(check_writable(folder.path() / "link"));
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
