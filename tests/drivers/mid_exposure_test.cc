#include "drivers/mid_exposure.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

using std::chrono::microseconds;
using std::chrono::seconds;

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
