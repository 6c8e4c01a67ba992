#include "core/geometry/tum.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/peak_memory.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using ::testing::HasSubstr;

class Tum : public ::testing::Test {
 protected:
  [[nodiscard]] Expected<std::vector<TumPose>> read(std::string_view text) const {
    return read_tum(folder_.write("poses.tum", text));
  }
  test::TemporaryFolder folder_;
};

TEST_F(Tum, ReadsCommentsBlanksTabsAndCrlf) {
  const auto poses = read(
      "\xEF\xBB\xBF# t tx ty tz qx qy qz qw\r\n"
      "\r\n"
      "1511000000.000000001\t1 -2 3e0   0 0 0 1 # still\r\n"
      "tag36h11:12 +1 2 3 0.5 0.5 0.5 0.5");
  ASSERT_TRUE(poses) << poses.error().message;
  ASSERT_EQ(poses->size(), 2U);
  EXPECT_EQ((*poses)[0].key, "1511000000.000000001");
  EXPECT_EQ((*poses)[0].pose.translation, Eigen::Vector3d(1, -2, 3));
  EXPECT_EQ((*poses)[1].key, "tag36h11:12");
  EXPECT_EQ((*poses)[1].pose.rotation.x(), 0.5);
}

TEST_F(Tum, QuaternionsAreNormalizedWithinOnePercent) {
  const auto near = read("1 0 0 0 0 0 0 1.0099");
  ASSERT_TRUE(near);
  EXPECT_EQ(near->front().pose.rotation.w(), 1);
  const auto far = read("1 0 0 0 0 0 0 1.0101");
  ASSERT_FALSE(far);
  EXPECT_EQ(far.error().kind, ErrorKind::bad_data);
}

TEST_F(Tum, BadLinesAreNamedByNumber) {
  for (const auto* line :
       {"1 0 0 0 0 0 0", "1 0 0 0 0 0 0 1 2", "1 0 0 x 0 0 0 1", "1 0 0 nan 0 0 0 1",
        "1 inf 0 0 0 0 0 1", "1 1e999 0 0 0 0 0 1", "1 0 0 0 0 0 0 0"}) {
    const auto poses = read(std::string("# header\n1 0 0 0 0 0 0 1\n") + line + "\n");
    ASSERT_FALSE(poses) << line;
    EXPECT_EQ(poses.error().kind, ErrorKind::bad_data);
    EXPECT_THAT(poses.error().message, HasSubstr("poses.tum: line 3: "));
  }
}

TEST_F(Tum, PositionsLieWithinAThousandKilometres) {
  EXPECT_TRUE(parse_tum("0 1e6 -1e6 1000000 0 0 0 1\n", "a.tum"));
  for (const char* bad : {"1000000.1", "-1e7", "1e308"}) {
    const auto poses = parse_tum(fmt::format("0 0 {} 0 0 0 0 1\n", bad), "a.tum");
    ASSERT_FALSE(poses) << bad;
    EXPECT_EQ(poses.error().message, fmt::format("a.tum: line 1: position of {} m, beyond 1000 km; "
                                                 "positions are in metres",
                                                 bad));
  }
}

TEST_F(Tum, AFileLargerThanAnyTrajectoryIsRefusedUnread) {
  const auto path = folder_.write("long.tum", "");
  const auto refusal_of = [&](std::uintmax_t bytes) {
    std::filesystem::resize_file(path, bytes);  // a hole: it takes no disk
    const auto poses = read_tum(path);
    return poses ? "accepted" : poses.error().message;
  };
  constexpr std::uintmax_t kLargest = std::uintmax_t{1} << 30;
  // Not for its size: for the hole that it is.
  EXPECT_THAT(refusal_of(kLargest), HasSubstr("sparse"));
  EXPECT_THAT(refusal_of(kLargest + 1), HasSubstr("larger than"));
}

TEST_F(Tum, FieldsThatNobodyAskedForTakeNoMemory) {
  std::string line;
  for (int i = 0; i < 2'000'000; ++i) line += "1 ";
  const auto path = folder_.write("wide.tum", line);
  std::string refusal;
  const std::size_t peak = test::peak_memory([&] { refusal = read_tum(path).error().message; });
  EXPECT_THAT(refusal, HasSubstr("2000000 fields instead of 8"));
  EXPECT_LT(peak, 4 * line.size());
}

TEST_F(Tum, AbsentFileIsNoInput) {
  const auto poses = read_tum(folder_.path() / "absent.tum");
  ASSERT_FALSE(poses);
  EXPECT_EQ(poses.error().kind, ErrorKind::no_input);
}

TEST_F(Tum, TextReadsBack) {
  const std::vector<TumPose> poses{{"12", {so3_exp({1, 2, 3}), {1.25, -1e6, 1e-9}}}};
  const auto back = read(format_tum(poses));
  ASSERT_TRUE(back);
  EXPECT_LT(back->front().pose.minus(poses.front().pose).norm(), 3e-9);
  EXPECT_EQ(
      format_tum({{"7", {}}}),
      "7 0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 1.000000000\n");
}

TEST(StampText, IsExactToTheNanosecond) {
  for (const std::int64_t ns :
       {std::int64_t{0}, std::int64_t{1}, std::int64_t{-1}, std::int64_t{1'511'000'000'000'000'001},
        std::int64_t{-1'500'000'000}, std::int64_t{9'200'000'000'999'999'999}}) {
    const auto back = parse_stamp_s(format_stamp_s(Stamp(ns)));
    ASSERT_TRUE(back) << ns;
    EXPECT_EQ(back->count(), ns);
  }
  EXPECT_EQ(format_stamp_s(Stamp(1'511'000'000'000'000'001)), "1511000000.000000001");
  EXPECT_EQ(format_stamp_s(Stamp(-1'500'000'000)), "-1.500000000");
  EXPECT_EQ(format_stamp_s(Stamp(std::numeric_limits<std::int64_t>::min())),
            "-9223372036.854775808");
}

TEST(StampText, OtherFormsOfSeconds) {
  EXPECT_EQ(parse_stamp_s("12")->count(), 12'000'000'000);
  EXPECT_EQ(parse_stamp_s("12.")->count(), 12'000'000'000);
  EXPECT_EQ(parse_stamp_s("+.5")->count(), 500'000'000);
  EXPECT_EQ(parse_stamp_s("0.12345678949")->count(), 123'456'789);
  EXPECT_EQ(parse_stamp_s("0.1234567895")->count(), 123'456'790);
}

TEST(StampText, WhatIsNoTimeIsRefused) {
  for (const auto* text : {"", ".", "-", "1e9", "nan", "1.2.3", "12a", " 12", "--1", "9200000001",
                           "99999999999999999999999999"}) {
    const auto stamp = parse_stamp_s(text);
    ASSERT_FALSE(stamp) << text;
    EXPECT_EQ(stamp.error().kind, ErrorKind::bad_data);
  }
}

}  // namespace
}  // namespace waymark
