#include "locd/publish/lcm_publisher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <waymark/alert_t.hpp>

#include "tests/support/own_network.h"

namespace waymark {
namespace {

using std::chrono::seconds;
using Link = LcmPublisher::Link;

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=1";
constexpr const char* kRoute = "ip link set lo up multicast on && ip route add 239.0.0.0/8 dev lo";
/// Packets leave so slowly that the socket is soon full.
constexpr const char* kStall = "tc qdisc add dev lo root tbf rate 1kbit burst 2000 limit 10mb";

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
  EXPECT_EQ(publisher.failures(), 0);
  EXPECT_EQ(publisher.last_failure(), Link::up);
}

TEST(LcmPublisher, AMessageTooLargeIsCountedAndTheNextOneGoesOut) {
  LcmPublisher publisher("memq://", Stamp{0});
  alert_t alert{};
  alert.text.assign(LcmPublisher::kMaxMessageBytes, 'x');
  EXPECT_FALSE(publisher.publish("WAYMARK_ALERT", alert, Stamp{0}));
  EXPECT_EQ(publisher.failures(), 1);
  EXPECT_EQ(publisher.last_failure(), Link::too_large);
  alert.text = "small";
  EXPECT_TRUE(publisher.publish("WAYMARK_ALERT", alert, Stamp{0}));
}

TEST(LcmPublisher, AGroupWithoutARouteIsCountedAndTriedAgain) {
  test::in_own_network([](const test::OwnNetwork& network) {
    LcmPublisher publisher(kUrl, Stamp{0});
    EXPECT_EQ(publisher.lcm(), nullptr);
    const alert_t alert{};
    for (int i = 1; i <= 100; ++i) {
      EXPECT_FALSE(publisher.publish("WAYMARK_ALERT", alert, seconds(i)));
      EXPECT_EQ(publisher.lcm(), nullptr) << "nothing takes LCM's place";
    }
    EXPECT_EQ(publisher.failures(), 100);
    EXPECT_EQ(publisher.last_failure(), Link::no_route);
    network.run(kRoute);
    EXPECT_TRUE(publisher.publish("WAYMARK_ALERT", alert, seconds(200)));
    EXPECT_EQ(publisher.failures(), 100);
  });
}

TEST(LcmPublisher, ANetworkThatTakesNoPacketsIsNotWaitedFor) {
  test::in_own_network([](const test::OwnNetwork& network) {
    network.run(kRoute);
    LcmPublisher publisher(kUrl, Stamp{0});
    network.run(kStall);
    alert_t alert{};
    alert.text.assign(900, 'x');
    constexpr int kMessages = 2000;  // more than any socket's buffer holds
    int taken = 0;
    for (int i = 0; i < kMessages; ++i) {
      taken += static_cast<int>(publisher.publish("WAYMARK_ALERT", alert, seconds(i)));
    }
    EXPECT_GT(taken, 0);
    EXPECT_EQ(publisher.failures(), kMessages - taken);
    EXPECT_EQ(publisher.last_failure(), Link::full);
    // A socket made anew would have had room for as many again.
    EXPECT_LT(taken, kMessages / 4);
    network.run("tc qdisc del dev lo root");
    EXPECT_TRUE(publisher.publish("WAYMARK_ALERT", alert, seconds(kMessages)));
  });
}

TEST(LcmPublisher, ASocketThatIsMadeAnewDoesNotWaitEither) {
  test::in_own_network([](const test::OwnNetwork& network) {
    LcmPublisher publisher(kUrl, Stamp{0});
    network.run(kRoute);
    network.run(kStall);
    alert_t alert{};
    alert.text.assign(900, 'x');
    int taken = 0;
    for (int i = 0; i < 500; ++i) {
      taken += static_cast<int>(publisher.publish("WAYMARK_ALERT", alert, seconds(10)));
    }
    EXPECT_GT(taken, 0);
    EXPECT_LT(taken, 500);
    EXPECT_EQ(publisher.last_failure(), Link::full);
  });
}

TEST(LcmPublisher, EveryReasonSaysWhatToDo) {
  const LcmUrl address = *parse_lcm_url(kUrl);
  EXPECT_THAT(describe(Link::no_route, address), testing::HasSubstr("239.255.76.67:7667"));
  EXPECT_THAT(describe(Link::full, address), testing::HasSubstr("is the interface up"));
  EXPECT_THAT(describe(Link::not_allowed, address), testing::HasSubstr("IPAddressAllow"));
}

}  // namespace
}  // namespace waymark
