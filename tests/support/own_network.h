#pragma once

#include <gtest/gtest.h>
#include <sched.h>

#include <cstdlib>
#include <string>
#include <thread>

namespace waymark::test {

/// A network of a test's own: nothing in it yet, and no packet leaves it. Needs root.
class OwnNetwork {
 public:
  /// A shell's command there.
  void run(const std::string& command) const {
    // NOLINTNEXTLINE(concurrency-mt-unsafe,cert-env33-c): the tools that set up networks
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
  }
};

/// Runs `test` in a thread that lives in such a network; sockets that it makes do, too.
template <typename Test>
void in_own_network(const Test& test) {
  std::thread([&] {
    ASSERT_EQ(::unshare(CLONE_NEWNET), 0) << "root may do that";
    test(OwnNetwork());
  }).join();
}

}  // namespace waymark::test
