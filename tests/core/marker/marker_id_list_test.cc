#include "core/marker/marker_id_list.h"

#include <gmock/gmock.h>

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
