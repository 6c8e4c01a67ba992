#include "drivers/frame_maker.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

/// Frames lost when a device counts on by `step`.
std::uint64_t lost_by(std::uint32_t step) {
  FrameMaker frames;
  EXPECT_EQ(frames.count(7), 7U);
  const std::uint64_t next = frames.count(7 + step);
  EXPECT_EQ(next, 7U + frames.lost() + 1);
  return frames.lost();
}

TEST(FrameMaker, AMillionFramesAtOnceAreANewCountNotAGap) {
  EXPECT_EQ(lost_by(1), 0U);
  EXPECT_EQ(lost_by(2), 1U);
  EXPECT_EQ(lost_by(999'999), 999'998U);
  EXPECT_EQ(lost_by(1'000'000), 0U);
}

}  // namespace
}  // namespace waymark
