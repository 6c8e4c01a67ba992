#include "drivers/v4l2/buffer_stamp.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

namespace waymark {
namespace {

using std::chrono::microseconds;
using std::chrono::seconds;

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

TEST(MidExposure, LiesHalfTheExposureAndHalfTheReadOutFromEitherEnd) {
  const ExposureTiming timing{microseconds(2000), microseconds(12'000)};
  EXPECT_EQ(mid_exposure(StampMeaning::start_of_exposure, seconds(1), timing).stamp,
            seconds(1) + microseconds(7000));
  EXPECT_EQ(mid_exposure(StampMeaning::end_of_frame, seconds(1), timing).stamp,
            seconds(1) - microseconds(7000));
  EXPECT_EQ(mid_exposure(StampMeaning::end_of_frame, seconds(1), timing).quality,
            StampQuality::exact);
}

TEST(MidExposure, IsApproximateWhereSomethingIsNotKnown) {
  const ExposureTiming automatic{Stamp{0}, microseconds(12'000)};
  const MidExposure unknown_length =
      mid_exposure(StampMeaning::start_of_exposure, seconds(1), automatic);
  EXPECT_EQ(unknown_length.stamp, seconds(1));
  EXPECT_EQ(unknown_length.quality, StampQuality::approximate);
  const ExposureTiming timing{microseconds(2000), microseconds(0)};
  const MidExposure unknown_meaning = mid_exposure(StampMeaning::unknown, seconds(1), timing);
  EXPECT_EQ(unknown_meaning.stamp, seconds(1));
  EXPECT_EQ(unknown_meaning.quality, StampQuality::approximate);
}

}  // namespace
}  // namespace waymark
