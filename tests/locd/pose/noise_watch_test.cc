#include "locd/pose/noise_watch.h"

#include <gtest/gtest.h>

#include "tests/locd/pose/room_drive.h"

namespace waymark {
namespace {

/// Learns from rooms of so much noise, set by set, without poses.
class NoiseWatched : public testing::Test {
 protected:
  static test::RoomOptions room_of(double noise_px) {
    test::RoomOptions options;
    options.frame_sets = 80;
    options.noise_px = noise_px;
    return options;
  }

  void learn(double noise_px) {
    const test::SyntheticRoom room = test::make_room(room_of(noise_px));
    for (std::size_t i = 0; i < room.images.size(); i += room.rig.cameras.size()) {
      std::vector<SetObservation> seen;
      for (std::size_t c = 0; c < room.rig.cameras.size(); ++c) {
        for (const Detection& d : room.images[i + c].detections) {
          SetObservation& o = seen.emplace_back();
          o.observation.camera = static_cast<int>(c);
          o.observation.size_m = 0.3;
          o.detected_px = d.corners;
          o.stated.fill(Eigen::Matrix2d::Zero());
        }
      }
      watch_.learn(room.images[i].stamp, seen, nullptr, solver_, alerts_);
    }
  }

  test::SyntheticRoom room_ = test::make_room(room_of(0.1));
  MapIndex map_{test::room_map(room_)};
  RigPoseSolver solver_{room_.rig, {}};
  NoiseWatch watch_{map_, room_.rig.cameras.size()};
  std::vector<Alert> alerts_;
};

TEST_F(NoiseWatched, LearnsEachCamerasNoiseWithoutAPose) {
  watch_.begin(false);
  EXPECT_TRUE(watch_.begun());
  learn(0.1);
  for (std::size_t c = 0; c < room_.rig.cameras.size(); ++c) {
    EXPECT_NEAR(watch_.sigmas_px()[c], 0.1, 0.02) << c;
    EXPECT_TRUE(watch_.settled(c)) << c;
  }
  EXPECT_TRUE(alerts_.empty());
}

TEST_F(NoiseWatched, SaysOnceWhereCornersAreFarNoisierThanUsual) {
  watch_.begin(false);
  learn(0.1);
  learn(1.5);
  ASSERT_EQ(alerts_.size(), room_.rig.cameras.size());
  for (const Alert& alert : alerts_) {
    EXPECT_EQ(alert.kind, AlertKind::corners_noisy);
    EXPECT_TRUE(alert.raised);
    EXPECT_GT(alert.value, 0.5);
  }
}

}  // namespace
}  // namespace waymark
