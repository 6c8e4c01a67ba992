#include "locd/frames/skew_watch.h"

#include <gtest/gtest.h>

#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

using std::chrono::microseconds;

/// Alerts of so many sets of one skew.
std::vector<Alert> after(SkewWatch& watch, int sets, Stamp skew) {
  std::vector<Alert> alerts;
  for (int i = 0; i < sets; ++i) watch.look(std::chrono::milliseconds(100 * i), skew, alerts);
  return alerts;
}

TEST(SkewWatch, TellsOnceThatATriggeredRigDoesNotExposeTogetherAndThatItDoesAgain) {
  SkewWatch watch({true, microseconds(1000), 10});
  EXPECT_TRUE(after(watch, 9, microseconds(1001)).empty());
  const auto raised = after(watch, 20, microseconds(1001));
  ASSERT_EQ(raised.size(), 1U);
  EXPECT_EQ(raised[0].kind, AlertKind::stamps_skewed);
  EXPECT_TRUE(raised[0].raised);
  EXPECT_TRUE(after(watch, 9, microseconds(1000)).empty());
  const auto ended = after(watch, 20, microseconds(1000));
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_FALSE(ended[0].raised);
}

TEST(SkewWatch, OneLateExposureIsNoBrokenTrigger) {
  SkewWatch watch({true, microseconds(1000), 10});
  for (int i = 0; i < 50; ++i) {
    EXPECT_TRUE(after(watch, 9, microseconds(9000)).empty());
    EXPECT_TRUE(after(watch, 1, microseconds(0)).empty());
  }
}

TEST(SkewWatch, CamerasThatRunFreeExposeWhenTheyLike) {
  SkewWatch watch({false, microseconds(1000), 10});
  EXPECT_TRUE(after(watch, 100, microseconds(11000)).empty());
}

TEST(SkewWatchOptions, AreHeldToTheirRanges) {
  expect_ranges<SkewWatchOptions>(
      {ranged("most in ms", &SkewWatchOptions::most, SkewWatchOptions::kMost_ms, 1000),
       ranged("sets", &SkewWatchOptions::sets, {2, 100})});
}

}  // namespace
}  // namespace waymark
