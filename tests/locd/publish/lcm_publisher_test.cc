#include "locd/publish/lcm_publisher.h"

#include <gtest/gtest.h>

#include <waymark/alert_t.hpp>

namespace waymark {
namespace {

using std::chrono::seconds;

struct Received {
  std::vector<alert_t> messages;
  void take(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
            const alert_t* message) {
    messages.push_back(*message);
  }
};

TEST(LcmPublisher, WhatIsPublishedArrives) {
  LcmPublisher publisher("memq://", Stamp{0});
  ASSERT_NE(publisher.lcm(), nullptr);
  Received received;
  publisher.lcm()->subscribe("WAYMARK_ALERT", &Received::take, &received);
  alert_t alert{};
  alert.seq = 7;
  alert.text = "MOVED: marker 12";
  EXPECT_TRUE(publisher.publish("WAYMARK_ALERT", alert, Stamp{0}));
  EXPECT_EQ(publisher.lcm()->handleTimeout(1000), 1);
  ASSERT_EQ(received.messages.size(), 1U);
  EXPECT_EQ(received.messages[0].seq, 7);
  EXPECT_EQ(received.messages[0].text, "MOVED: marker 12");
  EXPECT_TRUE(publisher.connected());
  EXPECT_EQ(publisher.failures(), 0);
}

TEST(LcmPublisher, AnAddressThatCannotBeReachedIsCountedAndNothingTakesItsPlace) {
  LcmPublisher publisher("file:///nonexistent/log?mode=w", Stamp{0});
  EXPECT_EQ(publisher.lcm(), nullptr);
  EXPECT_FALSE(publisher.connected());
  const alert_t alert{};
  for (int i = 1; i <= 100; ++i) {
    EXPECT_FALSE(publisher.publish("WAYMARK_ALERT", alert, seconds(i)));
    EXPECT_EQ(publisher.lcm(), nullptr);
  }
  EXPECT_EQ(publisher.failures(), 100);
}

}  // namespace
}  // namespace waymark
