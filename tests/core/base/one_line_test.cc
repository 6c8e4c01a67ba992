#include "core/base/one_line.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(InOneLine, SpellsOutWhatBreaksLinesAndTerminals) {
  EXPECT_EQ(in_one_line("pin\nhole\x1b[2J\t\x7f"), "pin\\nhole\\x1b[2J\\x09\\x7f");
}

TEST(InOneLine, LeavesTextAlone) {
  EXPECT_EQ(in_one_line("cam0: 30 Hz, größer als \\n"), "cam0: 30 Hz, größer als \\n");
}

}  // namespace
}  // namespace waymark
