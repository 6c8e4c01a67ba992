#include "locd/frames/image_health.h"

#include <gtest/gtest.h>

#include <functional>
#include <initializer_list>
#include <set>
#include <tuple>

#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

/// A wall with edges and a little noise; no two numbers give the same image.
GrayImage wall(int number) {
  GrayImage image(320, 240);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const int edge = (x / 40 + y / 40) % 2 == 0 ? 60 : 170;
      image.row(y)[x] = static_cast<std::uint8_t>(edge + (x * 7 + y * 13 + number * 31) % 5);
    }
  }
  image.row(0)[0] = static_cast<std::uint8_t>(number);
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

TEST(ImageHealth, ImagesFromBeforeAReloadAreKnownAfterIt) {
  ImageHealth before(2);
  std::vector<Alert> alerts;
  for (int i = 0; i < 5; ++i) before.look(1, wall(i).view(), std::chrono::milliseconds(i), alerts);
  ImageHealth after(2);
  after.remember_images_of(before);
  EXPECT_EQ(after.repeated(), 0U);
  // The last one, an older one, a new one; the other camera never gave any of them.
  for (const auto& [camera, number, known] :
       std::initializer_list<std::tuple<std::size_t, int, bool>>{
           {1, 4, true}, {1, 2, true}, {1, 9, false}, {0, 4, false}}) {
    after.look(camera, wall(number).view(), std::chrono::milliseconds(9), alerts);
    EXPECT_EQ((after.repeated() & camera_bit(camera)) != 0, known) << camera << ' ' << number;
  }
  EXPECT_TRUE(alerts.empty());
}

TEST(ImageHealth, WhereItIsNotKnownWhatWasGivenBeforeAFirstImageMayBeOld) {
  ImageHealthOptions options;
  for (const bool doubt : {false, true}) {
    options.doubt_first_images = doubt;
    ImageHealth health(2, options);
    std::vector<Alert> alerts;
    const auto tells_nothing = [&](int number) {
      health.look(1, wall(number).view(), Stamp{0}, alerts);
      return health.repeated() != 0;
    };
    EXPECT_EQ(tells_nothing(7), doubt);
    EXPECT_TRUE(tells_nothing(7)) << "frozen since before the start";
    EXPECT_FALSE(tells_nothing(8)) << "another proves that it is not";
    EXPECT_TRUE(alerts.empty());
  }
}

TEST(ImageHealth, OfACameraThatIsKnownNoFirstImageIsDoubtedAfterAReload) {
  ImageHealthOptions options;
  options.doubt_first_images = true;
  ImageHealth before(1, options);
  std::vector<Alert> alerts;
  before.look(0, wall(1).view(), Stamp{0}, alerts);
  ImageHealth after(1, options);
  after.remember_images_of(before);
  after.look(0, wall(2).view(), Stamp{1}, alerts);
  EXPECT_EQ(after.repeated(), 0U);
}

TEST(ImageHealth, AFrozenCameraIsNamedAnewAfterAReload) {
  ImageHealth before(1);
  std::vector<Alert> alerts;
  for (int i = 0; i < 3; ++i) before.look(0, wall(7).view(), std::chrono::milliseconds(i), alerts);
  ImageHealth after(1);
  after.remember_images_of(before);
  EXPECT_EQ(after.unhealthy(), 0U);
  alerts.clear();
  after.look(0, wall(7).view(), std::chrono::milliseconds(3), alerts);
  ASSERT_EQ(alerts.size(), 1U);
  EXPECT_EQ(alerts[0].kind, AlertKind::image_frozen);
  EXPECT_EQ(after.unhealthy(), camera_bit(0));
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

struct Pattern {
  const char* what;
  std::function<int(int)> image;  ///< which image is the i-th
  bool stale;
};

class StaleImages : public testing::TestWithParam<Pattern> {};

TEST_P(StaleImages, AreToldFromNewOnes) {
  ImageHealth health(1);
  std::vector<Alert> alerts;
  int used_again = 0;
  std::set<int> given;
  for (int i = 0; i < 60; ++i) {
    const int which = GetParam().image(i);
    health.look(0, wall(which).view(), std::chrono::milliseconds(i), alerts);
    const bool excluded = (health.repeated() | health.unhealthy()) != 0;
    if (!given.insert(which).second && GetParam().stale) used_again += excluded ? 0 : 1;
  }
  EXPECT_EQ(used_again, 0) << "an image that was given before";
  ASSERT_EQ(alerts.size(), GetParam().stale ? 1U : 0U);
  if (GetParam().stale) {
    EXPECT_EQ(alerts[0].kind, AlertKind::image_stale);
  }
}

INSTANTIATE_TEST_SUITE_P(
    ImageHealth, StaleImages,
    testing::Values(Pattern{"two in turn", [](int i) { return i % 2; }, true},
                    Pattern{"three in turn", [](int i) { return i % 3; }, true},
                    Pattern{"two in turn, each twice", [](int i) { return i / 2 % 2; }, true},
                    Pattern{"a ring of sixteen", [](int i) { return i % 16; }, true},
                    Pattern{"new ones, then two old ones in turn",
                            [](int i) { return i < 20 ? i : 18 + i % 2; }, true},
                    Pattern{"one that comes twice", [](int i) { return i == 7 ? 6 : i; }, false},
                    Pattern{"all new", [](int i) { return i; }, false}));

TEST(ImageHealth, ImagesThatAreOldNowAndThenAreNoFaultButNotUsed) {
  ImageHealth health(1);
  std::vector<Alert> alerts;
  for (int i = 0; i < 60; ++i) {
    const bool old = i % 3 == 2;
    health.look(0, wall(old ? i - 2 : i).view(), std::chrono::milliseconds(i), alerts);
    EXPECT_EQ(health.repeated() != 0, old);
  }
  EXPECT_TRUE(alerts.empty());
}

TEST(ImageHealth, StaleIsOverWithNewImages) {
  ImageHealth health(1);
  std::vector<Alert> alerts;
  for (int i = 0; i < 10; ++i)
    health.look(0, wall(i % 2).view(), std::chrono::milliseconds(i), alerts);
  ASSERT_EQ(alerts.size(), 1U);
  for (int i = 10; i < 14; ++i)
    health.look(0, wall(i).view(), std::chrono::milliseconds(i), alerts);
  ASSERT_EQ(alerts.size(), 2U);
  EXPECT_EQ(alerts[1].kind, AlertKind::image_stale);
  EXPECT_FALSE(alerts[1].raised);
  EXPECT_EQ(health.unhealthy(), 0U);
}

/// A marker whose corners tell the images apart.
std::vector<Detection> seen(int number) {
  Detection detection;
  detection.marker = {Family::tag36h11, 5};
  for (std::size_t k = 0; k < 4; ++k) detection.corners[k] = {10.0 * k, 20.0 + 1e-6 * number};
  return {detection};
}

TEST(ImageHealth, OfDetectionsThatComeInPlaceOfImagesStaleOnesAreToldToo) {
  ImageHealth health(2);
  std::vector<Alert> alerts;
  const auto look = [&](int i, const std::vector<Detection>& detections) {
    health.look(1, detections, std::chrono::milliseconds(i), alerts);
  };
  for (int i = 0; i < 40; ++i) look(i, seen(i));
  EXPECT_TRUE(alerts.empty());
  for (int i = 0; i < 40; ++i) look(i, {});
  EXPECT_TRUE(alerts.empty()) << "nothing in view is no fault";
  for (int i = 0; i < 3; ++i) look(i, seen(38 + i % 2));
  ASSERT_EQ(alerts.size(), 1U);
  EXPECT_EQ(alerts[0].kind, AlertKind::image_stale);
  EXPECT_EQ(alerts[0].camera, 1);
}

TEST(ImageHealthOptions, AreHeldToTheirRanges) {
  expect_ranges<ImageHealthOptions>(
      {ranged("identical_images", &ImageHealthOptions::identical_images, {2, 100}),
       ranged("dark_grey", &ImageHealthOptions::dark_grey, {1, 100}),
       ranged("bright_grey", &ImageHealthOptions::bright_grey, {100, 255}),
       ranged("saturated_share", &ImageHealthOptions::saturated_share, {0.1, 1}),
       ranged("edge_grey", &ImageHealthOptions::edge_grey, {1, 50}),
       ranged("sets_to_raise", &ImageHealthOptions::sets_to_raise, {1, 100}),
       ranged("sets_to_clear", &ImageHealthOptions::sets_to_clear, {1, 100})});
}

}  // namespace
}  // namespace waymark
