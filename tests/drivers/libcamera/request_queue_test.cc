#include "drivers/libcamera/request_queue.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <thread>

namespace waymark {
namespace {

constexpr Stamp kOver{0};

class RequestQueueTest : public testing::Test {
 protected:
  RequestQueueTest() { queue_.begin(); }

  /// Stands for a request: a queue only hands it on.
  [[nodiscard]] libcamera::Request* request(std::size_t index) {
    return reinterpret_cast<libcamera::Request*>(&requests_[index]);  // NOLINT: never looked into
  }

  /// What a take gives that waits while another thread does something.
  libcamera::Request* taken_while(const std::function<void()>& something) {
    std::thread other(something);
    libcamera::Request* const taken = queue_.take(monotonic_now() + std::chrono::seconds(60));
    other.join();
    return taken;
  }

  std::array<char, 2> requests_{};
  RequestQueue queue_;
};

TEST_F(RequestQueueTest, GivesTheOldestFirstAndNoneAtTheDeadline) {
  queue_.complete(request(0));
  queue_.complete(request(1));
  EXPECT_EQ(queue_.take(kOver), request(0));
  EXPECT_EQ(queue_.take(kOver), request(1));
  EXPECT_EQ(queue_.take(kOver), nullptr);
}

TEST_F(RequestQueueTest, ARequestComesAgainAsOftenAsItIsCompleted) {
  for (std::size_t round = 0; round < std::size_t{3} * BufferLender::kMaxBuffers; ++round) {
    queue_.complete(request(0));
    EXPECT_EQ(queue_.take(kOver), request(0));
    EXPECT_EQ(queue_.take(kOver), nullptr);
  }
}

TEST_F(RequestQueueTest, WhateverHappensEndsAWaitingTake) {
  EXPECT_EQ(taken_while([&] { queue_.complete(request(1)); }), request(1));
  EXPECT_EQ(taken_while([&] { queue_.wake(); }), nullptr);
  EXPECT_TRUE(queue_.was_woken());
  EXPECT_EQ(taken_while([&] { queue_.stop(); }), nullptr);
  EXPECT_FALSE(queue_.disconnected());
  queue_.begin();
  EXPECT_EQ(taken_while([&] { queue_.disconnect(); }), nullptr);
  EXPECT_TRUE(queue_.disconnected());
}

TEST_F(RequestQueueTest, AWakeIsKeptForTheNextTakeAndAskedForOnce) {
  queue_.wake();
  EXPECT_EQ(queue_.take(monotonic_now() + std::chrono::seconds(60)), nullptr);
  EXPECT_TRUE(queue_.was_woken());
  EXPECT_FALSE(queue_.was_woken());
}

TEST_F(RequestQueueTest, AWokenTakeLosesNoRequest) {
  queue_.wake();
  queue_.complete(request(0));
  EXPECT_EQ(queue_.take(kOver), request(0));
  EXPECT_TRUE(queue_.was_woken());
}

TEST_F(RequestQueueTest, NothingIsTakenOfACameraThatIsGone) {
  queue_.complete(request(0));
  queue_.disconnect();
  EXPECT_EQ(queue_.take(kOver), nullptr);
}

/// libcamera cancels what it still has when a camera stops: nothing of the next stream.
TEST_F(RequestQueueTest, ANewStreamKnowsNothingOfTheLast) {
  queue_.complete(request(0));
  queue_.wake();
  queue_.stop();
  queue_.disconnect();
  queue_.begin();
  EXPECT_FALSE(queue_.disconnected());
  EXPECT_FALSE(queue_.was_woken());
  EXPECT_EQ(queue_.take(kOver), nullptr);
  EXPECT_EQ(taken_while([&] { queue_.complete(request(1)); }), request(1));
}

}  // namespace
}  // namespace waymark
