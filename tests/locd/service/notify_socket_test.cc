#include "locd/service/notify_socket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/locd/service/daemon_fixture.h"
#include "tests/support/no_descriptors_left.h"

namespace waymark {
namespace {

using test::FakeSystemd;
using testing::HasSubstr;

TEST(NotifySocket, SystemdHearsAlsoWithoutAnyDescriptorLeft) {
  FakeSystemd systemd;
  const NotifySocket socket;
  const test::NoDescriptorsLeft none;
  socket.tell("READY=1");
  EXPECT_TRUE(socket.offer("WATCHDOG=1"));
  EXPECT_EQ(systemd.heard(), "READY=1\nWATCHDOG=1\n");
}

TEST(NotifySocket, WhatIsOfferedDoesNotWaitForASystemdThatIsBehind) {
  FakeSystemd systemd;
  const NotifySocket socket;
  constexpr int kMost = 10'000;  // more than any queue of the kernel's holds
  int taken = 0;
  while (taken < kMost && socket.offer("STATUS=x")) ++taken;
  EXPECT_LT(taken, kMost);
  systemd.listen();
  EXPECT_TRUE(socket.offer("STATUS=it listens again"));
  EXPECT_THAT(systemd.heard(), HasSubstr("it listens again"));
}

TEST(NotifySocket, WithoutSystemdNothingHappens) {
  ::unsetenv("NOTIFY_SOCKET");
  const NotifySocket socket;
  socket.tell("READY=1");
  EXPECT_TRUE(socket.offer("WATCHDOG=1"));
}

TEST(NotifySocket, AnAbstractNameIsOneToo) {
  const Descriptor listener(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = fmt::format("waymark-test-{}", ::getpid());
  std::copy(name.begin(), name.end(), std::begin(address.sun_path) + 1);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
  ASSERT_EQ(::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address),
                   static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size())),
            0);
  ::setenv("NOTIFY_SOCKET", ("@" + name).c_str(), 1);
  const NotifySocket socket;
  ::unsetenv("NOTIFY_SOCKET");
  socket.tell("READY=1");
  std::array<char, 16> heard{};
  EXPECT_EQ(::recv(listener.get(), heard.data(), heard.size(), 0), 7);
  EXPECT_STREQ(heard.data(), "READY=1");
}

}  // namespace
}  // namespace waymark
