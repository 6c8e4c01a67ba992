#include "mapbuilder/diagnosis/clock_findings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace waymark {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr Stamp kStart = std::chrono::seconds(1'700'000'000);

/// Three cameras at `period`; the stamps of one are changed.
template <typename Change>
std::vector<StampedImage> drive(int camera, Stamp period, const Change& change,
                                double lost = 0.03) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform;
  std::vector<StampedImage> images;
  for (int i = 0; i < 120; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (uniform(random) < lost) continue;
      const Stamp jitter = microseconds(static_cast<int>(400 * uniform(random)));
      const Stamp stamp = kStart + i * period + jitter;
      images.push_back({k, k == camera ? change(stamp) : stamp});
    }
  }
  return images;
}

std::vector<Finding> found_in(const std::vector<StampedImage>& images) {
  return clock_findings(images, {"cam0", "cam1", "cam2"}, kDefaultSyncTolerance);
}

TEST(ClockFindings, CamerasThatKeepTimeAreNotAccused) {
  for (const int period_ms : {33, 100, 1000}) {
    EXPECT_THAT(found_in(drive(1, milliseconds(period_ms), [](Stamp s) { return s; })),
                testing::IsEmpty());
    EXPECT_THAT(
        found_in(drive(1, milliseconds(period_ms), [](Stamp s) { return s + milliseconds(3); })),
        testing::IsEmpty());
  }
}

TEST(ClockFindings, AConstantOffsetIsToldWithItsSign) {
  for (const int camera : {0, 1, 2}) {
    for (const int offset_ms : {-40, -11, 8, 11, 100}) {
      SCOPED_TRACE(testing::Message() << "cam" << camera << " by " << offset_ms << " ms");
      const auto found = found_in(
          drive(camera, milliseconds(333), [&](Stamp s) { return s + milliseconds(offset_ms); }));
      ASSERT_EQ(found.size(), 1U);
      EXPECT_EQ(found[0].cause, Cause::clock);
      EXPECT_EQ(found[0].subject, "cam" + std::to_string(camera));
      EXPECT_NEAR(found[0].figures[0].value, offset_ms, 0.5);
      EXPECT_THAT(found[0].text, HasSubstr(offset_ms > 0 ? "ahead of" : "behind"));
    }
  }
}

TEST(ClockFindings, AnotherEpochIsToldWithHowFarItLies) {
  const auto found = found_in(
      drive(1, milliseconds(100), [](Stamp s) { return s - kStart + std::chrono::seconds(500); }));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].subject, "cam1");
  EXPECT_THAT(found[0].text, HasSubstr("53.9 years before"));
}

/// A clock that is off by so much after a while; with `stairs` it is only read now and then.
Stamp drifted(Stamp stamp, double ppm, Stamp stairs) {
  Stamp since = stamp - kStart;
  if (stairs.count() > 0) since -= since % stairs;
  return stamp + Stamp(static_cast<std::int64_t>(1e-6 * ppm * static_cast<double>(since.count())));
}

TEST(ClockFindings, ADriftIsToldWithItsRateSmoothOrInStairs) {
  for (const int camera : {0, 1, 2}) {
    for (const double ppm : {-3000.0, 900.0, 1500.0, 5000.0}) {
      for (const int stairs_ms : {0, 600, 1400}) {
        SCOPED_TRACE(testing::Message()
                     << "cam" << camera << " " << ppm << " ppm, stairs of " << stairs_ms << " ms");
        const auto found = found_in(drive(camera, milliseconds(100), [&](Stamp s) {
          return drifted(s, ppm, milliseconds(stairs_ms));
        }));
        ASSERT_EQ(found.size(), 1U);
        EXPECT_EQ(found[0].subject, "cam" + std::to_string(camera));
        const double rate = 0.06 * ppm;  // ms/min
        EXPECT_NEAR(found[0].figures[0].value, rate, 0.05 * std::abs(rate)) << found[0].text;
      }
    }
  }
}

TEST(ClockFindings, ACameraThatRunsFreeIsNotAccused) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform;
  EXPECT_THAT(found_in(drive(1, milliseconds(100),
                             [&](Stamp s) {
                               return s + milliseconds(static_cast<int>(90 * uniform(random)));
                             })),
              testing::IsEmpty());
}

TEST(ClockFindings, TooFewImagesTellNothing) {
  std::vector<StampedImage> images;
  for (int i = 0; i < 5; ++i) {
    images.push_back({0, kStart + i * milliseconds(100)});
    images.push_back({1, kStart + i * milliseconds(100) + milliseconds(40)});
  }
  EXPECT_THAT(found_in(images), testing::IsEmpty());
  EXPECT_THAT(found_in({}), testing::IsEmpty());
}

}  // namespace
}  // namespace waymark
