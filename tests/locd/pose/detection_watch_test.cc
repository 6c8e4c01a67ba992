#include "locd/pose/detection_watch.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

constexpr CameraMask kBoth = 0b11;

std::vector<Alert> after(DetectionWatch& watch, int sets, CameraMask searched, CameraMask failed) {
  std::vector<Alert> alerts;
  for (int i = 0; i < sets; ++i) watch.look(searched, failed, Stamp(i), alerts);
  return alerts;
}

TEST(DetectionWatch, NamesTheCameraOnceWhenItFailsOnAndOnAndOnceWhenItIsOver) {
  DetectionWatch watch;
  EXPECT_TRUE(after(watch, DetectionWatch::kSets - 1, kBoth, 0b10).empty());
  const auto raised = after(watch, 10, kBoth, 0b10);
  ASSERT_EQ(raised.size(), 1U);
  EXPECT_EQ(raised[0].kind, AlertKind::image_unsearched);
  EXPECT_TRUE(raised[0].raised);
  EXPECT_EQ(raised[0].camera, 1);
  EXPECT_TRUE(after(watch, DetectionWatch::kSets - 1, kBoth, 0).empty());
  const auto over = after(watch, 10, kBoth, 0);
  ASSERT_EQ(over.size(), 1U);
  EXPECT_FALSE(over[0].raised);
  EXPECT_EQ(over[0].camera, 1);
}

TEST(DetectionWatch, AFailureNowAndThenIsNoLastingOne) {
  DetectionWatch watch;
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(after(watch, DetectionWatch::kSets - 1, kBoth, 0b01).empty());
    EXPECT_TRUE(after(watch, 1, kBoth, 0).empty());
  }
}

TEST(DetectionWatch, SetsInWhichACameraIsNotSearchedTellNothingOfIt) {
  DetectionWatch watch;
  ASSERT_EQ(after(watch, DetectionWatch::kSets, kBoth, 0b01).size(), 1U);
  EXPECT_TRUE(after(watch, 100, 0b10, 0).empty());
  EXPECT_EQ(after(watch, DetectionWatch::kSets, 0b01, 0).size(), 1U);
}

}  // namespace
}  // namespace waymark
