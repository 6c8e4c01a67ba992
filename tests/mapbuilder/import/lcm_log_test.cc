#include "mapbuilder/import/lcm_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/lcm_log_text.h"
#include "tests/support/peak_memory.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using test::lcm_event;
using testing::HasSubstr;

/// What ends the reading of a log: empty at its end.
std::string end_of(const TemporaryFolder& folder, const std::string& content, int& events) {
  auto log = LcmLog::open(folder.write("a.lcm", content));
  EXPECT_TRUE(log);
  for (events = 0;; ++events) {
    const auto event = log->next();
    if (!event) return event.error().message;
    if (!*event) return {};
  }
}

TEST(LcmLog, GivesEventsInTheirOrder) {
  const TemporaryFolder folder;
  auto log = LcmLog::open(folder.write("a.lcm", lcm_event("POSE", "one") + lcm_event("B", "")));
  ASSERT_TRUE(log);
  const auto first = log->next();
  ASSERT_TRUE(first && *first);
  EXPECT_EQ((*first)->channel, "POSE");
  EXPECT_EQ((*first)->timestamp_us, 1'700'000'000'000'000);
  EXPECT_EQ(std::string((*first)->data.begin(), (*first)->data.end()), "one");
  const auto second = log->next();
  ASSERT_TRUE(second && *second);
  EXPECT_EQ((*second)->size, 0U);
  const auto end = log->next();
  ASSERT_TRUE(end);
  EXPECT_FALSE(*end);
}

TEST(LcmLog, DamageIsSaidWithWhatIsWhole) {
  const TemporaryFolder folder;
  const std::string good = lcm_event("POSE", "one");
  int events = 0;
  EXPECT_EQ(end_of(folder, good + good, events), "");
  for (std::size_t cut = 1; cut < good.size(); ++cut) {
    const std::string why = end_of(folder, good + good.substr(0, cut), events);
    EXPECT_THAT(why, HasSubstr("truncated LCM log"));
    EXPECT_THAT(why, HasSubstr("head -c " + std::to_string(good.size())));
    EXPECT_EQ(events, 1);
  }
  EXPECT_THAT(end_of(folder, good + "x" + good, events), HasSubstr("no event begins there"));
}

TEST(LcmLog, ChannelsAreAsLongAsLcmsOwn) {
  const TemporaryFolder folder;
  int events = 0;
  EXPECT_EQ(end_of(folder, lcm_event(std::string(63, 'C'), "x"), events), "");
  EXPECT_THAT(end_of(folder, lcm_event(std::string(64, 'C'), "x"), events), HasSubstr("64 bytes"));
  EXPECT_THAT(end_of(folder, lcm_event("", "x"), events), HasSubstr("0 bytes"));
}

TEST(LcmLog, LargerMessagesArePassedOver) {
  const TemporaryFolder folder;
  const std::string at_limit(LcmLog::kLargestMessage, 'a');
  auto log = LcmLog::open(
      folder.write("a.lcm", lcm_event("A", at_limit) + lcm_event("B", at_limit + "a")));
  ASSERT_TRUE(log);
  EXPECT_EQ((*log->next())->data.size(), at_limit.size());
  const auto large = log->next();
  ASSERT_TRUE(large && *large);
  EXPECT_EQ((*large)->size, LcmLog::kLargestMessage + 1);
  EXPECT_TRUE((*large)->data.empty());
}

TEST(LcmLog, WhatItStatesTakesNoMemory) {
  const TemporaryFolder folder;
  std::string event = lcm_event("A", "x");
  for (std::size_t i = 24; i < 28; ++i) event[i] = '\x7F';  // the message's size
  int events = 0;
  const std::size_t memory =
      test::peak_memory([&] { EXPECT_THAT(end_of(folder, event, events), HasSubstr("cut off")); });
  EXPECT_LT(memory, 50'000'000U);
}

}  // namespace
}  // namespace waymark
