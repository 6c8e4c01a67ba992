// Once a stream runs, its frames take no memory but what was taken at its start.
#include <gtest/gtest.h>

#include <memory>

#include "drivers/frame_maker.h"
#include "tests/support/allocation_count.h"

namespace waymark {
namespace {

/// Allocations of a hundred frames, two of which are lent at a time.
long allocations_of_frames(std::string_view format) {
  const FrameLayout layout{find_pixel_format(format), 64, 48, 128};
  const auto memory = std::make_shared<std::vector<std::uint8_t>>(128 * 48);
  FrameMaker frames;
  frames.begin(layout, memory, FrameMaker::kBuffers);
  std::optional<Frame> held;
  int buffers_given_back = 0;
  const long before = testing::allocations();
  for (std::uint32_t i = 0; i < 100; ++i) {
    FrameMaker::Made made = frames.make(i % FrameMaker::kBuffers, *memory, {});
    held = std::move(made.frame);
    buffers_given_back += made.buffer_is_free ? 1 : 0;
    while (frames.take_returned()) ++buffers_given_back;
  }
  const long during = testing::allocations() - before;
  EXPECT_EQ(frames.lost(), 0U);
  EXPECT_GE(buffers_given_back, 99);
  return during;
}

TEST(FrameAllocation, FramesInTheDriversOwnMemoryTakeNone) {
  EXPECT_EQ(allocations_of_frames("GREY"), 0);
}

TEST(FrameAllocation, ConvertedFramesTakeNone) { EXPECT_EQ(allocations_of_frames("Y16"), 0); }

TEST(FrameAllocation, IsCountedHere) {
  const long before = testing::allocations();
  const auto taken = std::make_unique<int>(1);
  EXPECT_EQ(testing::allocations(), before + *taken);
}

}  // namespace
}  // namespace waymark
