#include "core/marker/marker_id.h"

#include <gmock/gmock.h>

namespace waymark {
namespace {

using testing::HasSubstr;

TEST(MarkerId, OrderedByFamilyThenNumber) {
  EXPECT_LT((MarkerId{Family::aruco_4x4_50, 40}), (MarkerId{Family::tag36h11, 3}));
  EXPECT_LT((MarkerId{Family::tag36h11, 3}), (MarkerId{Family::tag36h11, 12}));
  EXPECT_NE((MarkerId{Family::tag36h10, 3}), (MarkerId{Family::tag36h11, 3}));
}

TEST(MarkerId, WrittenBareOrWithItsFamily) {
  const MarkerId id{Family::tag36h11, 12};
  EXPECT_EQ(format_marker_id(id, false), "12");
  EXPECT_EQ(format_marker_id(id, true), "tag36h11:12");
}

TEST(MarkerId, ReadsWhatIsWritten) {
  const MarkerId id{Family::aruco_original, 1023};
  EXPECT_EQ(*parse_marker_id("1023", Family::aruco_original), id);
  EXPECT_EQ(*parse_marker_id("aruco_original:1023", std::nullopt), id);
  EXPECT_EQ(*parse_marker_id("aruco_original:1023", Family::tag36h11), id);
}

TEST(MarkerId, BareNumberNeedsAFamily) {
  const auto id = parse_marker_id("12", std::nullopt);
  ASSERT_FALSE(id);
  EXPECT_EQ(id.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(id.error().message, HasSubstr("several families"));
}

TEST(MarkerId, RefusesEverythingElse) {
  for (const char* text : {"", "-1", "1.0", "x", " 1", "1 ", "tag36h11:", ":1", "tag36h11:-1",
                           "nosuch:1", "tag36h11:1:2", "99999999999"}) {
    const auto id = parse_marker_id(text, Family::tag36h11);
    ASSERT_FALSE(id) << text;
    EXPECT_EQ(id.error().kind, ErrorKind::bad_data);
  }
  EXPECT_TRUE(parse_marker_id("586", Family::tag36h11));
  EXPECT_THAT(parse_marker_id("587", Family::tag36h11).error().message, HasSubstr("0 to 586"));
}

}  // namespace
}  // namespace waymark
