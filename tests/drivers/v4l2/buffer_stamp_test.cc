#include "drivers/v4l2/buffer_stamp.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

namespace waymark {
namespace {

TEST(StampMeaning, IsWhatTheFlagsSay) {
  constexpr std::uint32_t kMonotonic = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  constexpr std::uint32_t kOther = V4L2_BUF_FLAG_MAPPED | V4L2_BUF_FLAG_DONE;
  EXPECT_EQ(stamp_meaning(kMonotonic | V4L2_BUF_FLAG_TSTAMP_SRC_SOE | kOther),
            StampMeaning::start_of_exposure);
  EXPECT_EQ(stamp_meaning(kMonotonic | V4L2_BUF_FLAG_TSTAMP_SRC_EOF | kOther),
            StampMeaning::end_of_frame);
  EXPECT_EQ(stamp_meaning(V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN | V4L2_BUF_FLAG_TSTAMP_SRC_SOE),
            StampMeaning::unknown);
  EXPECT_EQ(stamp_meaning(V4L2_BUF_FLAG_TIMESTAMP_COPY | V4L2_BUF_FLAG_TSTAMP_SRC_SOE),
            StampMeaning::unknown);
}

}  // namespace
}  // namespace waymark
