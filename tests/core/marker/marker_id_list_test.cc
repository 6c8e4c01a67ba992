#include "core/marker/marker_id_list.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <ctime>

namespace waymark {
namespace {

using testing::HasSubstr;

MarkerId tag36(int number) { return {Family::tag36h11, number}; }
MarkerId tag16(int number) { return {Family::tag16h5, number}; }

TEST(MarkerIdList, IsReadRisingAndEachOnce) {
  EXPECT_EQ(*parse_marker_ids("7, 3-5,4", Family::tag36h11),
            (std::vector<MarkerId>{tag36(3), tag36(4), tag36(5), tag36(7)}));
  EXPECT_EQ(*parse_marker_ids("tag36h11:3-4, tag16h5:1", std::nullopt),
            (std::vector<MarkerId>{tag16(1), tag36(3), tag36(4)}));
  EXPECT_EQ(*parse_marker_ids("tag16h5:1, 9", Family::tag36h11),
            (std::vector<MarkerId>{tag16(1), tag36(9)}));
}

TEST(MarkerIdList, OverlappingRangesAreWalkedOnce) {
  std::string text = "tag16h5:3, tagstandard52h13:7-9";
  for (int i = 0; i < 4'000; ++i) text += ",tagstandard52h13:0-48000";
  const std::clock_t begin = std::clock();
  const auto ids = parse_marker_ids(text, std::nullopt);
  const double cpu_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  ASSERT_TRUE(ids) << ids.error().message;
  EXPECT_EQ(ids->size(), 48'002U);
  EXPECT_TRUE(std::is_sorted(ids->begin(), ids->end()));
  EXPECT_LT(cpu_s, 1 + 1e-6 * static_cast<double>(text.size()));
}

TEST(MarkerIdList, RefusesWhatItCanNotMean) {
  const auto why = [](const char* text, std::optional<Family> family) {
    const auto ids = parse_marker_ids(text, family);
    EXPECT_FALSE(ids) << text;
    EXPECT_EQ(ids.error().kind, ErrorKind::bad_data);
    return ids.error().message;
  };
  EXPECT_THAT(why("", Family::tag36h11), HasSubstr("no id and no range"));
  EXPECT_THAT(why("3,", Family::tag36h11), HasSubstr("no id and no range"));
  EXPECT_THAT(why("3", std::nullopt), HasSubstr("several families"));
  EXPECT_THAT(why("nosuch:3", Family::tag36h11), HasSubstr("unknown family"));
  EXPECT_THAT(why("tag16h5:30", Family::tag36h11), HasSubstr("0 to 29"));
}

TEST(MarkerIdList, IsWrittenAsItIsRead) {
  const std::vector<MarkerId> ids{tag16(1), tag36(3), tag36(4), tag36(9)};
  EXPECT_EQ(format_marker_ids(ids, true), "tag16h5:1, tag36h11:3-4, tag36h11:9");
  EXPECT_EQ(*parse_marker_ids(format_marker_ids(ids, true), std::nullopt), ids);
  EXPECT_EQ(format_marker_ids(std::vector{tag36(3), tag36(4)}, false), "3-4");
  EXPECT_EQ(format_marker_ids(ids, true, 1), "tag16h5:1, … (4 in all)");
  EXPECT_EQ(format_marker_ids({}, false), "");
}

}  // namespace
}  // namespace waymark
