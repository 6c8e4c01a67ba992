#include "core/marker/id_range.h"

#include <gmock/gmock.h>

namespace waymark {
namespace {

TEST(IdRange, IsOneIdOrARun) {
  EXPECT_EQ(parse_id_range("7")->first, 7);
  EXPECT_EQ(parse_id_range("7")->last, 7);
  EXPECT_EQ(parse_id_range(" 100 - 199 ")->first, 100);
  EXPECT_EQ(parse_id_range("100-199")->last, 199);
  EXPECT_EQ(parse_id_range("5-5")->last, 5);
}

TEST(IdRange, NothingElse) {
  for (const char* text : {"", "-", "7-", "-7", "9-7", "a", "1-2-3", "1.5", "99999999999"}) {
    EXPECT_FALSE(parse_id_range(text)) << text;
  }
}

TEST(IdRanges, AreReadInTheirOrder) {
  const auto ranges = parse_id_ranges("100-199, 5", Family::tag36h11);
  ASSERT_TRUE(ranges);
  ASSERT_EQ(ranges->size(), 2U);
  EXPECT_EQ(ranges->front().first, 100);
  EXPECT_EQ(ranges->back().last, 5);
  EXPECT_TRUE(parse_id_ranges("586", Family::tag36h11));
}

TEST(IdRanges, NameThePartThatIsAtFault) {
  EXPECT_THAT(parse_id_ranges("1,,2", Family::tag36h11).error().message,
              testing::HasSubstr("\"\" is no id and no range"));
  EXPECT_THAT(parse_id_ranges("1, 2-x", Family::tag36h11).error().message,
              testing::HasSubstr("\"2-x\" is no id"));
  EXPECT_EQ(parse_id_ranges("500-587", Family::tag36h11).error().message,
            "id 587: tag36h11 has the ids 0 to 586 only");
}

TEST(IdRanges, AreWrittenAsTheyAreRead) {
  EXPECT_EQ(format_id_ranges(std::vector<int>{3, 4, 5, 9, 11, 12}), "3-5, 9, 11-12");
  EXPECT_EQ(format_id_ranges({}), "");
}

}  // namespace
}  // namespace waymark
