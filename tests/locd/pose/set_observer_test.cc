#include "locd/pose/set_observer.h"

#include <gtest/gtest.h>

#include "tests/locd/pose/room_drive.h"

namespace waymark {
namespace {

class Observed : public testing::Test {
 protected:
  static test::RoomOptions usual() {
    test::RoomOptions options;
    options.frame_sets = 5;
    options.state_covariances = true;
    return options;
  }

  void look(const FrameSetLease& set) {
    estimate_.reset(PoseReason::no_markers, set);
    observer_.look(set, std::nullopt, estimate_, alerts_);
  }

  test::RoomDrive drive_{test::make_room(usual())};
  Rig& rig_ = drive_.room().rig;
  MapIndex map_{test::room_map(drive_.room())};
  SetObserver observer_{rig_, map_, {}};
  PoseEstimate estimate_;
  std::vector<Alert> alerts_;
};

TEST_F(Observed, EveryDetectionIsReportedAndMappedOnesAreUsed) {
  look(drive_.set(0));
  EXPECT_FALSE(observer_.used().empty());
  EXPECT_EQ(observer_.used().size(), estimate_.observations.size());
  EXPECT_TRUE(observer_.others().empty());
  EXPECT_EQ(observer_.usable(), drive_.set(0).cameras);
  map_.set_quarantined(observer_.used()[0].map_index, true);
  look(drive_.set(1));
  EXPECT_FALSE(observer_.others().empty());
  EXPECT_EQ(observer_.all().size(), estimate_.observations.size());
  EXPECT_EQ(estimate_.observations[observer_.others()[0].report_index].verdict,
            ObservationVerdict::quarantined);
}

TEST_F(Observed, ASuspectCameraIsLeftOutWhereTheOthersShowTwoMarkers) {
  look(drive_.set(0));
  const std::size_t before = observer_.used().size();
  observer_.leave_out(camera_bit(1), estimate_);
  EXPECT_LT(observer_.used().size(), before);
  EXPECT_EQ(observer_.all().size(), before);
  for (const SetObservation& o : observer_.used()) EXPECT_NE(o.observation.camera, 1);
  for (const SetObservation& o : observer_.others()) EXPECT_EQ(o.observation.camera, 1);
  // All of them: nothing would be left.
  look(drive_.set(1));
  observer_.leave_out(drive_.set(1).cameras, estimate_);
  EXPECT_FALSE(observer_.used().empty());
  EXPECT_TRUE(observer_.others().empty());
}

TEST_F(Observed, CornersHaveTheInstantsOfTheirRows) {
  rig_.cameras[0].readout_us = 10'000;
  look(drive_.set(0));
  observer_.time_corners(drive_.set(0), estimate_);
  for (const SetObservation& o : observer_.used()) {
    for (std::size_t i = 0; i < 4; ++i) {
      const double expected = o.observation.camera == 0 ? 0.010 * o.row[i] : 0;
      EXPECT_NEAR(o.after_s[i], expected, 1e-12);
      EXPECT_LE(std::abs(o.row[i]), 0.5);
    }
  }
}

}  // namespace
}  // namespace waymark
