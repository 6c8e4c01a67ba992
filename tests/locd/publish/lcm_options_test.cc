#include "locd/publish/lcm_options.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(ChannelPrefix, HasOneToFiftyCharactersThatPrint) {
  EXPECT_TRUE(is_channel_prefix(LcmOptions{}.channel_prefix));
  EXPECT_TRUE(is_channel_prefix("!"));
  EXPECT_TRUE(is_channel_prefix(std::string(50, '~')));
  EXPECT_FALSE(is_channel_prefix(""));
  EXPECT_FALSE(is_channel_prefix(std::string(51, '~')));
  for (const char* blank : {"A B", "A\tB", "A\x7f", "\xc3\x84"})
    EXPECT_FALSE(is_channel_prefix(blank));
  EXPECT_FALSE(is_channel_prefix(std::string_view("A\0B", 3)));
}

}  // namespace
}  // namespace waymark
