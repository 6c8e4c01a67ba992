#include "core/base/error.h"

#include <gtest/gtest.h>

#include "core/base/check.h"

namespace waymark {
namespace {

Expected<int> half_of(int number) {
  if (number % 2 != 0) return fail(ErrorKind::bad_data, "{}: odd; give an even number", number);
  return number / 2;
}

TEST(Error, CarriesOneLineAndItsExitCode) {
  EXPECT_EQ(*half_of(8), 4);
  const auto failed = half_of(7);
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().message, "7: odd; give an even number");
  EXPECT_EQ(failed.error().exit_code(), 65);
}

TEST(Error, OfAKnownCauseReadsAsAFinding) {
  const Status plain = fail(ErrorKind::no_input, "room: can't open");
  EXPECT_EQ(line_of(plain.error(), "mapbuilder"), "mapbuilder: room: can't open");
  const Status known = fail(Cause::csv, "{}: every row stands twice", "room.csv");
  EXPECT_EQ(line_of(known.error(), "mapbuilder"), "error [csv] room.csv: every row stands twice");
  EXPECT_EQ(known.error().exit_code(), 65);
}

TEST(Error, WhateverItQuotesIsOnePrintableLine) {
  const std::string hostile = "T_x\nWATCHDOG=trigger\x1b[2J\u009b\xff";
  const auto failed = fail(ErrorKind::config, "rig.yaml: unknown key \"{}\"; remove it", hostile);
  EXPECT_EQ(failed.value().message,
            "rig.yaml: unknown key \"T_x\\nWATCHDOG=trigger\\x1b[2J\\u009b\\xff\"; remove it");
  EXPECT_EQ(Error(ErrorKind::io, hostile).message, "T_x\\nWATCHDOG=trigger\\x1b[2J\\u009b\\xff");
}

TEST(Error, WhateverItQuotesIsShort) {
  const auto failed = fail(ErrorKind::bad_data, "{}: unknown", std::string(200'000, 'a'));
  EXPECT_LE(failed.value().message.size(), 500U);
  // Errors quote errors.
  const auto outer = fail(ErrorKind::bad_data, "rig.yaml: {}; mend it", failed.value().message);
  EXPECT_LE(outer.value().message.size(), 500U);
}

TEST(Error, KindsAreTheSysexitsCodes) {
  EXPECT_EQ(Error({ErrorKind::usage, ""}).exit_code(), 64);
  EXPECT_EQ(Error({ErrorKind::no_input, ""}).exit_code(), 66);
  EXPECT_EQ(Error({ErrorKind::unavailable, ""}).exit_code(), 69);
  EXPECT_EQ(Error({ErrorKind::internal, ""}).exit_code(), 70);
  EXPECT_EQ(Error({ErrorKind::cant_create, ""}).exit_code(), 73);
  EXPECT_EQ(Error({ErrorKind::io, ""}).exit_code(), 74);
  EXPECT_EQ(Error({ErrorKind::permission, ""}).exit_code(), 77);
  EXPECT_EQ(Error({ErrorKind::config, ""}).exit_code(), 78);
}

TEST(CheckDeathTest, StopsWithTheConditionInEveryBuild) {
  WAYMARK_CHECK(1 + 1 == 2);
  EXPECT_DEATH(WAYMARK_CHECK(1 + 1 == 3), "internal check failed: 1 \\+ 1 == 3");
}

}  // namespace
}  // namespace waymark
