#include "locd/frames/image_health.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

/// A wall with edges and a little noise that differs from image to image.
GrayImage wall(int number) {
  GrayImage image(320, 240);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const int edge = (x / 40 + y / 40) % 2 == 0 ? 60 : 170;
      image.row(y)[x] = static_cast<std::uint8_t>(edge + (x * 7 + y * 13 + number * 31) % 5);
    }
  }
  return image;
}

GrayImage flat(int grey, int number) {
  GrayImage image(320, 240, static_cast<std::uint8_t>(grey));
  image.row(0)[0] = static_cast<std::uint8_t>(number);
  return image;
}

struct Outcome {
  std::vector<Alert> alerts;
  CameraMask unhealthy = 0;
};

template <typename Make>
Outcome look(int images, const Make& make) {
  ImageHealth health(2);
  Outcome outcome;
  for (int i = 0; i < images; ++i) {
    health.look(1, make(i).view(), std::chrono::milliseconds(i), outcome.alerts);
  }
  outcome.unhealthy = health.unhealthy();
  return outcome;
}

TEST(ImageHealth, AWallIsFine) { EXPECT_TRUE(look(20, wall).alerts.empty()); }

TEST(ImageHealth, ThreeIdenticalImagesAreFrozenTwoAreNot) {
  EXPECT_TRUE(look(2, [](int) { return wall(0); }).alerts.empty());
  const Outcome frozen = look(3, [](int) { return wall(0); });
  ASSERT_EQ(frozen.alerts.size(), 1U);
  EXPECT_EQ(frozen.alerts[0].kind, AlertKind::image_frozen);
  EXPECT_EQ(frozen.alerts[0].camera, 1);
  EXPECT_EQ(frozen.unhealthy, camera_bit(1));
}

TEST(ImageHealth, DarkSaturatedObscured) {
  const auto only_kind = [](const Outcome& outcome) {
    EXPECT_EQ(outcome.alerts.size(), 1U);
    return outcome.alerts.empty() ? AlertKind::marker_moved : outcome.alerts[0].kind;
  };
  EXPECT_EQ(only_kind(look(3, [](int i) { return flat(3, i); })), AlertKind::image_dark);
  EXPECT_EQ(only_kind(look(3, [](int i) { return flat(254, i); })), AlertKind::image_saturated);
  EXPECT_EQ(only_kind(look(3, [](int i) { return flat(90, i); })), AlertKind::image_obscured);
  EXPECT_TRUE(look(2, [](int i) { return flat(3, i); }).alerts.empty()) << "not in a row yet";
}

TEST(ImageHealth, EndsWhenImagesAreFineAgain) {
  const Outcome outcome = look(10, [](int i) { return i < 4 ? flat(3, i) : wall(i); });
  ASSERT_EQ(outcome.alerts.size(), 2U);
  EXPECT_FALSE(outcome.alerts[1].raised);
  EXPECT_EQ(outcome.alerts[1].stamp, std::chrono::milliseconds(6));
  EXPECT_EQ(outcome.unhealthy, 0U);
}

}  // namespace
}  // namespace waymark
