#include "core/capture/stamp_doubt.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace waymark {
namespace {

/// What is doubted of twenty images of two cameras each, `spacing` apart from `first` on.
std::string doubt(std::int64_t first, std::int64_t spacing, bool monotonic = false) {
  std::vector<StampedImage> images;
  for (int i = 0; i < 20; ++i) {
    for (int camera = 0; camera < 2; ++camera) {
      images.push_back({camera, Stamp(first + i * spacing)});
    }
  }
  return doubt_of_stamps(images, monotonic).value_or("");
}

TEST(DoubtOfStamps, NothingIsSaidOfNanoseconds) {
  EXPECT_EQ(doubt(1'511'000'000'000'000'000, 33'333'333), "");
  EXPECT_EQ(doubt(0, 33'333'333), "");
  EXPECT_EQ(doubt(1'000'000'000, 100'000), "") << "ten thousand images a second";
}

TEST(DoubtOfStamps, OtherUnitsAndFrameNumbersAreToldFromThem) {
  EXPECT_NE(doubt(1'511'000'000, 1).find("look like s ("), std::string::npos);
  EXPECT_NE(doubt(1'511'000'000'000, 33).find("look like ms ("), std::string::npos);
  EXPECT_NE(doubt(1'511'000'000'000'000, 33'333).find("look like µs ("), std::string::npos);
  EXPECT_NE(doubt(0, 1).find("look like frame numbers"), std::string::npos);
  EXPECT_NE(doubt(5'000'000'000, 99'999).find("no camera is that fast"), std::string::npos);
}

TEST(DoubtOfStamps, AClockOfAMachinesStartMayCountSlowly) {
  EXPECT_NE(doubt(1'511'000'000'000'000, 5'000'000).find("look like µs"), std::string::npos);
  EXPECT_EQ(doubt(1'511'000'000'000'000, 5'000'000, true), "");
}

TEST(DoubtOfSpan, StampsOfOneCaptureLieWithinACenturyAndAHalf) {
  const std::int64_t last = kLargestStamp.count();
  const auto far = [](std::int64_t a, std::int64_t b) {
    return doubt_of_span(std::vector<StampedImage>{{0, Stamp(a)}, {1, Stamp(b)}, {0, Stamp(a)}})
        .has_value();
  };
  EXPECT_FALSE(far(0, last));
  EXPECT_FALSE(far(last, 0));
  EXPECT_FALSE(far(-last, 0));
  EXPECT_TRUE(far(-1, last));
  EXPECT_TRUE(far(last, -last));
  EXPECT_FALSE(doubt_of_span({}));
}

TEST(DoubtOfStamps, SomeThatAreZeroAmongOthersAreSaid) {
  std::vector<StampedImage> images{{0, Stamp(0)}};
  for (int i = 0; i < 5; ++i) {
    images.push_back({0, Stamp(1'511'000'000'000'000'000 + i * 33'333'333)});
  }
  EXPECT_TRUE(doubt_of_stamps(images).value_or("").starts_with("1 of 6 stamps are 0"));
}

}  // namespace
}  // namespace waymark
