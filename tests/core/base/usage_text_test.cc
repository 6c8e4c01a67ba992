#include "core/base/usage_text.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(UsageText, QuotesArgumentsAsOnePrintableLine) {
  EXPECT_EQ(usage_text("--nosuch"), "--nosuch\nRun with --help for more information.\n");
  EXPECT_EQ(usage_text("\x1b]0;x\a\n\u202e"),
            "\\x1b]0;x\\x07\\n\\u202e\nRun with --help for more information.\n");
  EXPECT_LT(usage_text(std::string(100'000, 'x')).size(), kMaxLineBytes + 50);
}

}  // namespace
}  // namespace waymark
