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
