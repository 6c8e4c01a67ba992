#include "mapbuilder/print/paper.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(Paper, HasANameOrItsSides) {
  EXPECT_EQ(paper_from_name("a4")->height_mm, 297);
  EXPECT_EQ(paper_from_name("a3")->width_mm, 297);
  EXPECT_EQ(paper_from_name("letter")->width_mm, 215.9);
  EXPECT_EQ(paper_from_name("300x400.5")->width_mm, 300);
  EXPECT_EQ(paper_from_name("300x400.5")->height_mm, 400.5);
  EXPECT_EQ(paper_from_name("50x2000")->turned().width_mm, 2000);
}

TEST(Paper, NothingElse) {
  for (const char* name : {"", "a5", "A4", "x", "300", "300x", "x400", "nanx400", "300x400mm",
                           "49.9x400", "300x2000.1", "-300x400", "infxinf"}) {
    const auto paper = paper_from_name(name);
    ASSERT_FALSE(paper) << name;
    EXPECT_EQ(paper.error().kind, ErrorKind::usage);
  }
}

}  // namespace
}  // namespace waymark
