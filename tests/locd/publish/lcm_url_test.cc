#include "locd/publish/lcm_url.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace waymark {
namespace {

using testing::HasSubstr;
using namespace std::string_view_literals;

TEST(LcmUrl, SaysGroupPortAndTtl) {
  const auto url = parse_lcm_url("udpm://239.1.2.3:7777?recv_buf_size=2000000&ttl=3");
  ASSERT_TRUE(url) << url.error().message;
  EXPECT_EQ(url->text(), "239.1.2.3:7777");
  EXPECT_EQ(url->ttl, 3);
}

TEST(LcmUrl, WhatIsLeftOutIsLcmsDefault) {
  for (const char* text : {"udpm://", "udpm://:7667", "udpm://239.255.76.67", "udpm://?ttl=0"}) {
    const auto url = parse_lcm_url(text);
    ASSERT_TRUE(url) << text << url.error().message;
    EXPECT_EQ(url->text(), "239.255.76.67:7667") << text;
    EXPECT_EQ(url->ttl, 0);
  }
  EXPECT_FALSE(parse_lcm_url("memq://")->group);
}

TEST(LcmUrl, TheEdgesAreTaken) {
  for (const char* text :
       {"udpm://224.0.0.0:1", "udpm://239.255.255.255:65535?ttl=255", "udpm://239.1.1.1:7?ttl=0"}) {
    EXPECT_TRUE(parse_lcm_url(text)) << text;
  }
}

struct Refused {
  std::string_view url;
  const char* says;
};

class BadLcmUrls : public testing::TestWithParam<Refused> {};

TEST_P(BadLcmUrls, AreRefusedWithTheirReason) {
  const auto url = parse_lcm_url(GetParam().url);
  ASSERT_FALSE(url);
  EXPECT_EQ(url.error().kind, ErrorKind::config);
  EXPECT_THAT(url.error().message, HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    LcmUrl, BadLcmUrls,
    testing::Values(Refused{"", "must begin with udpm://"},
                    Refused{"tcp://239.1.1.1:7667", "must begin with udpm://"},
                    Refused{"mpudpm://239.1.1.1:7667", "must begin with udpm://"},
                    // A disk that stalls would hold up poses.
                    Refused{"file:///nonexistent", "must begin with udpm://"},
                    Refused{"memq://x?ttl=1", "neither address nor options"},
                    Refused{"udpm://192.168.1.10:7667?ttl=1",
                            "192.168.1.10 is no multicast address (224.0.0.0 to 239.255.255.255)"},
                    Refused{"udpm://223.255.255.255:7667", "no multicast address"},
                    Refused{"udpm://240.0.0.0:7667", "no multicast address"},
                    Refused{"udpm://999.1.1.1:7667", "no IPv4 address"},
                    Refused{"udpm://239.1.1:7667", "no IPv4 address"},
                    Refused{"udpm://239.1.1.1 :7667", "no IPv4 address"},
                    Refused{"udpm://239.1.1.1\0x:7667"sv, "no IPv4 address"},
                    Refused{"udpm://group.example:7667", "no IPv4 address"},
                    Refused{"udpm://ff02::1", "no IPv4 address"},
                    Refused{"udpm://239.1.1.1:99999", "port \"99999\""},
                    Refused{"udpm://239.1.1.1:0", "port \"0\""},
                    Refused{"udpm://239.1.1.1:-1", "port"}, Refused{"udpm://239.1.1.1:", "port"},
                    Refused{"udpm://239.1.1.1:7667:1", "port"},
                    Refused{"udpm://239.1.1.1:7667/x", "port"},
                    Refused{"udpm://239.1.1.1:7667?tll=1",
                            "unknown option tll; known: ttl, recv_buf_size"},
                    Refused{"udpm://239.1.1.1:7667?TTL=1", "unknown option TTL"},
                    Refused{"udpm://239.1.1.1:7667?ttl=0&ttl=5", "ttl is given twice"},
                    Refused{"udpm://239.1.1.1:7667?ttl=256", "from 0 to 255"},
                    Refused{"udpm://239.1.1.1:7667?ttl=", "from 0 to 255"},
                    Refused{"udpm://239.1.1.1:7667?ttl", "from 0 to 255"},
                    Refused{"udpm://239.1.1.1:7667?ttl=1 ", "from 0 to 255"},
                    Refused{"udpm://239.1.1.1:7667?ttl=1\0"sv, "from 0 to 255"},
                    Refused{"udpm://239.1.1.1:7667?ttl=1&&recv_buf_size=9", "unknown option"},
                    Refused{"udpm://239.1.1.1:7667?ttl=1?ttl=5", "from 0 to 255"},
                    Refused{"udpm://239.1.1.1:7667?recv_buf_size=0", "recv_buf_size"}));

}  // namespace
}  // namespace waymark
