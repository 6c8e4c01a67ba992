#include "core/base/text_field.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace waymark {
namespace {

TEST(TextField, TrimmedTakesBlanksOffBothEnds) {
  EXPECT_EQ(trimmed("  a b\t\r"), "a b");
  EXPECT_EQ(trimmed("a"), "a");
  EXPECT_EQ(trimmed(" \t\r "), "");
  EXPECT_EQ(trimmed(""), "");
}

TEST(TextField, ParseWholeTakesOneNumberAndNothingElse) {
  EXPECT_EQ(parse_whole<int>("-12"), -12);
  EXPECT_EQ(parse_whole<double>("1.5e3"), 1500.0);
  EXPECT_EQ(parse_whole<std::int64_t>("9223372036854775807"), INT64_MAX);
  for (const char* text : {"", " 1", "1 ", "1,5", "+1", "0x1", "one", "1.0"}) {
    EXPECT_FALSE(parse_whole<int>(text)) << '"' << text << '"';
  }
  EXPECT_FALSE(parse_whole<std::int64_t>("9223372036854775808"));
  EXPECT_FALSE(parse_whole<unsigned>("-1"));
  EXPECT_FALSE(parse_whole<double>("1.5 px"));
}

}  // namespace
}  // namespace waymark
