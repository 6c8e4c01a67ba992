#include "core/marker/id_range.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace waymark
