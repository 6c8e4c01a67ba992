#include "locd/publish/multicast_route.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/own_network.h"

namespace waymark {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string route_of(const char* url) { return describe_route(*parse_lcm_url(url)); }

TEST(MulticastRoute, NamesTheInterfaceAndWhoGetsIn) {
  test::in_own_network([](const test::OwnNetwork& network) {
    EXPECT_THAT(route_of("udpm://239.255.76.67:7667"), HasSubstr("there is no route"));
    network.run("ip link set lo up multicast on && ip route add 239.0.0.0/8 dev lo");
    EXPECT_THAT(route_of("udpm://239.255.76.67:7667?ttl=0"),
                AllOf(HasSubstr("leave by lo"), HasSubstr("other machines neither hear")));
    network.run(
        "ip link add out0 type veth peer name far0 && ip address add 192.168.77.1/24 dev out0 && "
        "ip link set out0 up && ip link set far0 up && ip route add 239.9.0.0/16 dev out0");
    EXPECT_THAT(route_of("udpm://239.9.1.1:7667?ttl=0"),
                AllOf(HasSubstr("out0"), HasSubstr("ip route add 239.0.0.0/8 dev lo")));
    EXPECT_THAT(route_of("udpm://239.9.1.1:7667?ttl=1"),
                AllOf(HasSubstr("leave by out0"), HasSubstr("key_file")));
    EXPECT_THAT(route_of("udpm://239.255.76.67:7667?ttl=0"), HasSubstr("leave by lo"));
  });
}

TEST(MulticastRoute, WithinTheProcessThereIsNone) {
  EXPECT_THAT(route_of("memq://"), HasSubstr("nobody hears"));
}

}  // namespace
}  // namespace waymark
