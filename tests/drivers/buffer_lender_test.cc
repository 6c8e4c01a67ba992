#include "drivers/buffer_lender.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(BufferLender, LendsUpToItsLimitAndLeavesWhatComesBack) {
  BufferLender lender;
  lender.begin(std::make_shared<int>(), 2);
  const auto a = lender.lend(3);
  const auto b = lender.lend(1);
  ASSERT_TRUE(a && b);
  EXPECT_FALSE(lender.lend(0));
  lender.take_back(*b);
  EXPECT_TRUE(lender.lend(0));
  EXPECT_EQ(lender.take_returned(), 1U);
  EXPECT_EQ(lender.take_returned(), std::nullopt);
}

TEST(BufferLender, WakesOnlyForWhatTheDriverWaitsFor) {
  int woken = 0;
  BufferLender lender([&] { ++woken; });
  lender.begin(std::make_shared<int>(), 3);
  const auto a = lender.lend(0);
  const auto b = lender.lend(1);
  lender.take_back(*a);  // the driver has one more than it must
  EXPECT_EQ(woken, 0);
  const auto c = lender.lend(2);
  lender.take_back(*b);  // the first has not been given to it yet
  EXPECT_EQ(woken, 1);
  EXPECT_TRUE(lender.take_returned() && lender.take_returned());
  lender.take_back(*c);
  EXPECT_EQ(woken, 1);
  const auto d = lender.lend(0);
  lender.end();
  lender.take_back(*d);
  lender.begin(std::make_shared<int>(), 1, true);
  lender.take_back(*lender.lend(0));
  EXPECT_EQ(woken, 1);
}

TEST(BufferLender, KeepsTheMemoryOfAnEndedStreamUntilItsLastFrameIsBack) {
  BufferLender lender;
  auto memory = std::make_shared<int>();
  const std::weak_ptr<int> watched = memory;
  lender.begin(std::move(memory), 3);
  const auto a = lender.lend(0);
  const auto b = lender.lend(1);
  lender.begin(std::make_shared<int>(), 3);
  const auto c = lender.lend(0);
  EXPECT_NE(*a, *c);
  lender.take_back(*a);
  EXPECT_FALSE(watched.expired());
  lender.take_back(*b);
  EXPECT_TRUE(watched.expired());
  EXPECT_EQ(lender.take_returned(), std::nullopt);
  lender.take_back(*c);
  EXPECT_EQ(lender.take_returned(), 0U);
}

TEST(BufferLender, LetsGoOfMemoryAtOnceWhenNothingIsLent) {
  BufferLender lender;
  auto memory = std::make_shared<int>();
  const std::weak_ptr<int> watched = memory;
  lender.begin(std::move(memory), 3);
  lender.end();
  EXPECT_TRUE(watched.expired());
}

}  // namespace
}  // namespace waymark
