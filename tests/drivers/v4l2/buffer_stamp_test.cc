#include "drivers/v4l2/buffer_stamp.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <limits>

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

TEST(BufferStamp, IsWhatABufferStatesUnlessNoClockCanShowIt) {
  using std::chrono::seconds;
  EXPECT_EQ(buffer_stamp({1000, 1}), seconds(1000) + std::chrono::microseconds(1));
  EXPECT_EQ(buffer_stamp({4'000'000'000, 0}), seconds(4'000'000'000));
  EXPECT_EQ(buffer_stamp({-4'000'000'000, 999'999}),
            seconds(-4'000'000'000) + std::chrono::microseconds(999'999));
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  for (const timeval& wild : {timeval{4'000'000'001, 0}, timeval{-4'000'000'001, 0},
                              timeval{kMost, 0}, timeval{-kMost, 0}, timeval{1, -1},
                              timeval{1, 1'000'000}, timeval{1, kMost}, timeval{1, -kMost}}) {
    EXPECT_EQ(buffer_stamp(wild), Stamp{0}) << wild.tv_sec << " s " << wild.tv_usec << " µs";
  }
}

}  // namespace
}  // namespace waymark
