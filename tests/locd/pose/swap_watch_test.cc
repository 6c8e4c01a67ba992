// What is said of cameras over time, from detections to alerts, and taken back.
#include "locd/pose/swap_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "tests/locd/pose/room_drive.h"
#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

constexpr std::size_t kCameras = 3;
constexpr int kSets = 100;

/// Three neighbours of a ring of five: in a whole ring every swap looks like every other one, seen
/// from a rig that is turned.
test::SyntheticRoom room_of_three() {
  test::RoomOptions options;
  options.frame_sets = kSets;
  options.noise_px = 0.1;
  options.state_covariances = true;
  options.markers = 60;
  options.cameras = 5;
  auto room = test::make_room(options);
  room.rig.cameras.erase(room.rig.cameras.begin() + kCameras, room.rig.cameras.end());
  std::erase_if(room.images, [](const auto& i) { return i.camera >= static_cast<int>(kCameras); });
  return room;
}

using Frames = std::array<ImageDetections, kCameras>;

/// What the cameras see, after somebody had his hands on them.
using Fault = std::function<void(Frames&)>;

Fault nothing() {
  return [](Frames&) {};
}

/// The plugs of two cameras are in each other's place.
Fault swapped(std::size_t a, std::size_t b) {
  return [=](Frames& frames) { std::swap(frames[a].detections, frames[b].detections); };
}

/// A camera was turned about its optical axis.
Fault rolled(std::size_t camera, double degrees) {
  return [=](Frames& frames) {
    const Eigen::Rotation2Dd turn(degrees * 3.14159265358979 / 180);
    const Eigen::Vector2d middle(639.5, 479.5);
    for (Detection& detection : frames[camera].detections) {
      for (Eigen::Vector2d& corner : detection.corners) corner = middle + turn * (corner - middle);
    }
  };
}

/// A vehicle that drives its round again and again.
class CameraVerdicts : public testing::Test {
 protected:
  struct Outcome {
    int ok = 0;
    int last_not_ok = -1;  ///< set, −1: every one was OK
    std::vector<Alert> alerts;
    std::vector<int> when;  ///< the set of each
  };

  Outcome drive(int sets, const Fault& fault) {
    Outcome outcome;
    for (int i = 0; i < sets; ++i, ++driven_) {
      Frames frames;
      FrameSetLease set = drive_.set(static_cast<std::size_t>(driven_ % kSets));
      for (std::size_t c = 0; c < kCameras; ++c) frames[c] = *set.frames[c].detections();
      fault(frames);
      for (std::size_t c = 0; c < kCameras; ++c) {
        FrameInfo info;
        info.stamp = test::room_stamp(driven_);
        set.frames[c] = Frame(info, {}, &frames[c], nullptr, 0);
      }
      localizer_.localize(set, estimate_);
      (estimate_.status == PoseStatus::ok ? outcome.ok : outcome.last_not_ok) +=
          estimate_.status == PoseStatus::ok ? 1 : i - outcome.last_not_ok;
      for (const Alert& alert : localizer_.alerts()) {
        outcome.alerts.push_back(alert);
        outcome.when.push_back(i);
      }
    }
    return outcome;
  }

  test::RoomDrive drive_{room_of_three()};
  Localizer localizer_{drive_.room().rig, test::room_map(drive_.room()), {}};
  PoseEstimate estimate_;
  int driven_ = 0;
};

class Swaps : public CameraVerdicts,
              public testing::WithParamInterface<std::pair<std::size_t, std::size_t>> {};

TEST_P(Swaps, AreNamedAndOverWhenPutRightAndNamedAgain) {
  const auto [a, b] = GetParam();
  for (int round = 0; round < 2; ++round) {
    const Outcome wrong = drive(kSets, swapped(a, b));
    ASSERT_EQ(wrong.alerts.size(), 1U) << "round " << round;
    EXPECT_EQ(wrong.alerts[0].kind, AlertKind::cameras_swapped);
    EXPECT_TRUE(wrong.alerts[0].raised);
    EXPECT_EQ(wrong.alerts[0].camera, static_cast<int>(a));
    EXPECT_EQ(wrong.alerts[0].other_camera, static_cast<int>(b));
    EXPECT_EQ(wrong.ok, 0);

    const Outcome right = drive(2 * kSets, nothing());
    ASSERT_EQ(right.alerts.size(), 1U) << "round " << round;
    EXPECT_TRUE(same_subject(right.alerts[0], wrong.alerts[0]));
    EXPECT_FALSE(right.alerts[0].raised);
    EXPECT_LE(right.when[0], 60);
    EXPECT_LE(right.last_not_ok, right.when[0] + 1) << "OK as before, without a restart";
  }
}

INSTANTIATE_TEST_SUITE_P(Camera, Swaps,
                         testing::Values(std::pair<std::size_t, std::size_t>{0, 1},
                                         std::pair<std::size_t, std::size_t>{0, 2},
                                         std::pair<std::size_t, std::size_t>{1, 2}));

TEST_F(CameraVerdicts, AKnockedCameraIsNamedAndOverWhenPutBack) {
  const Outcome knocked = drive(2 * kSets, rolled(1, 1.0));
  ASSERT_EQ(knocked.alerts.size(), 1U);
  EXPECT_EQ(knocked.alerts[0].kind, AlertKind::extrinsics_off);
  const Outcome back = drive(5 * kSets, nothing());
  ASSERT_EQ(back.alerts.size(), 1U);
  EXPECT_TRUE(same_subject(back.alerts[0], knocked.alerts[0]));
  EXPECT_FALSE(back.alerts[0].raised);
  EXPECT_LE(back.last_not_ok, back.when[0] + 1);
}

TEST_F(CameraVerdicts, ASwapOfAKnockedCameraEndsWhatWasSaidOfItFirst) {
  const Outcome knocked = drive(2 * kSets, rolled(0, 1.0));
  ASSERT_EQ(knocked.alerts.size(), 1U);
  const Outcome wrong = drive(kSets, swapped(0, 2));
  ASSERT_EQ(wrong.alerts.size(), 2U);
  EXPECT_EQ(wrong.alerts[0].kind, AlertKind::extrinsics_off);
  EXPECT_FALSE(wrong.alerts[0].raised);
  EXPECT_EQ(wrong.alerts[1].kind, AlertKind::cameras_swapped);
  EXPECT_TRUE(wrong.alerts[1].raised);
}

TEST(SwapWatchOptions, AreHeldToTheirRanges) {
  expect_ranges<SwapWatchOptions>(
      {ranged("trusted_share", &SwapWatchOptions::trusted_share, {0.5, 1}),
       ranged("swap_sets", &SwapWatchOptions::swap_sets, {2, 1000}),
       ranged("right_sets", &SwapWatchOptions::right_sets, {2, 1000}),
       ranged("coherent_share", &SwapWatchOptions::coherent_share, {0.5, 1})});
}

}  // namespace
}  // namespace waymark
