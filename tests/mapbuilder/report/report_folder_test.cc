#include "mapbuilder/report/report_folder.h"

#include <gtest/gtest.h>

#include "tests/mapbuilder/report/small_report.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

Status write_report(const fs::path& folder, const Report& report) {
  auto written = ReportFolder::write(folder, report);
  if (!written) return tl::make_unexpected(written.error());
  return written->put_in_place();
}

TEST(ReportFolder, IsWrittenWhole) {
  const TemporaryFolder tmp;
  const fs::path folder = tmp.path() / "report";
  ASSERT_TRUE(write_report(folder, test::small_report()));
  EXPECT_EQ(entries(folder), 2U);
  EXPECT_TRUE(fs::exists(folder / "summary.json"));
  EXPECT_TRUE(fs::exists(folder / "index.html"));
  EXPECT_EQ(entries(tmp.path()), 1U) << "something temporary was left behind";
}

TEST(ReportFolder, NothingIsThereBeforeItIsPutInPlace) {
  const TemporaryFolder tmp;
  {
    const auto written = ReportFolder::write(tmp.path() / "report", test::small_report());
    ASSERT_TRUE(written);
    EXPECT_FALSE(fs::exists(tmp.path() / "report"));
  }
  EXPECT_EQ(entries(tmp.path()), 0U) << "what was not put in place is removed";
}

TEST(ReportFolder, AnEarlierReportAndAnEmptyFolderAreReplaced) {
  const TemporaryFolder tmp;
  const fs::path folder = tmp.path() / "report/";
  fs::create_directory(folder);
  ASSERT_TRUE(write_report(folder, test::small_report()));
  auto report = test::small_report();
  report.map_name = "second.map";
  ASSERT_TRUE(write_report(folder, report));
  EXPECT_NE(tmp.read("report/summary.json").find("second.map"), std::string::npos);
  EXPECT_EQ(entries(tmp.path()), 1U);
}

TEST(ReportFolder, AnythingElseIsLeftAlone) {
  const TemporaryFolder tmp;
  tmp.write("photos/holiday.jpg", "x");
  tmp.write("site/index.html", "<!doctype html><title>mine</title>");
  tmp.write("site/summary.json", "{}");
  tmp.write("file", "x");
  ASSERT_TRUE(write_report(tmp.path() / "report", test::small_report()));
  tmp.write("report/notes.txt", "x");
  fs::create_directory_symlink(tmp.path() / "photos", tmp.path() / "link");
  for (const char* name : {"photos", "site", "file", "report", "link"}) {
    const auto status = write_report(tmp.path() / name, test::small_report());
    ASSERT_FALSE(status) << name;
    EXPECT_EQ(status.error().kind, ErrorKind::cant_create) << name;
    EXPECT_NE(status.error().message.find(name), std::string::npos);
  }
  EXPECT_EQ(tmp.read("site/summary.json"), "{}");
  EXPECT_EQ(tmp.read("file"), "x");
}

TEST(ReportFolder, WhatCameInTheMeantimeIsLeftAloneToo) {
  const TemporaryFolder tmp;
  auto written = ReportFolder::write(tmp.path() / "report", test::small_report());
  ASSERT_TRUE(written);
  tmp.write("report/mine.txt", "x");
  EXPECT_FALSE(written->put_in_place());
  EXPECT_EQ(tmp.read("report/mine.txt"), "x");
}

TEST(ReportFolder, AnAbsentParentIsSaid) {
  const TemporaryFolder tmp;
  const auto status = check_report_folder(tmp.path() / "absent/report");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::cant_create);
}

}  // namespace
}  // namespace waymark
