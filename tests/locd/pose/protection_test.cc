// Levels as locd publishes them, against errors whose truth is known.
#include "locd/pose/protection.h"

#include <gtest/gtest.h>

#include "tests/locd/pose/room_drive.h"

namespace waymark {
namespace {

test::RoomOptions usual() {
  test::RoomOptions options;
  options.frame_sets = 120;
  options.noise_px = 0.1;
  options.state_covariances = true;
  options.markers = 60;
  return options;
}

/// Errors against levels over one round.
struct Stanford {
  int poses = 0;
  int bounded = 0;
  int beyond = 0;
  double level_m = 0;  ///< summed over the bounded
  double error_m = 0;

  void add(const PoseEstimate& estimate, const Rigid3& truth) {
    if (!estimate.has_pose()) return;
    ++poses;
    const Protection& levels = estimate.protection;
    if (!levels.finite()) return;
    ++bounded;
    const Vector6d error = estimate.world_from_rig.minus(truth);
    const bool within = (error.head<3>().cwiseAbs().array() <= levels.axis_m.array()).all() &&
                        error.head<2>().norm() <= levels.horizontal_m &&
                        error.tail<3>().norm() <= levels.rotation_rad;
    beyond += within ? 0 : 1;
    level_m += levels.horizontal_m;
    error_m += error.head<2>().norm();
  }
};

Stanford drive(const test::RoomDrive& drive, const Rig& told, const MarkerMap& map) {
  Localizer localizer(told, map, {});
  PoseEstimate estimate;
  Stanford stanford;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    localizer.localize(drive.set(i), estimate);
    stanford.add(estimate, const_cast<test::RoomDrive&>(drive).room().world_from_rig[i]);
  }
  return stanford;
}

TEST(ProtectionLevels, HoldTheErrorWhileNothingIsWrongAndAreOfItsSize) {
  test::RoomDrive room(test::make_room(usual()));
  const Stanford s = drive(room, room.room().rig, test::room_map(room.room()));
  EXPECT_EQ(s.beyond, 0);
  EXPECT_GT(s.bounded, 0.9 * s.poses);
  EXPECT_LT(s.level_m, 25 * s.error_m) << "a mean error is a third of its 95 % quantile";
}

TEST(ProtectionLevels, HoldWhateverOneMarkerIsOffBy) {
  test::RoomDrive room(test::make_room(usual()));
  for (const double off_m : {0.002, 0.005, 0.01, 0.03, 0.3}) {
    MarkerMap map = test::room_map(room.room());
    for (std::size_t m = 0; m < 60; m += 20) {
      map.submaps[0].markers[m].world_from_marker.translation +=
          off_m * Eigen::Vector3d(0.6, 0.64, 0.48);
    }
    EXPECT_EQ(drive(room, room.room().rig, map).beyond, 0) << off_m;
  }
}

TEST(ProtectionLevels, HoldWhateverOneCameraIsOffBy) {
  test::RoomDrive room(test::make_room(usual()));
  for (const double off_rad : {0.0005, 0.002, 0.005, 0.02}) {
    Rig told = room.room().rig;
    told.cameras[1].rig_from_cam.rotation =
        told.cameras[1].rig_from_cam.rotation * so3_exp(off_rad * Eigen::Vector3d(0.6, -0.8, 0));
    EXPECT_EQ(drive(room, told, test::room_map(room.room())).beyond, 0) << off_rad;
  }
}

TEST(ProtectionLevels, AreNoneOfTwoMarkersAndSayThatOneCameraIsNotHeld) {
  test::RoomDrive room(test::make_room(usual()));
  MarkerMap map = test::room_map(room.room());
  Localizer localizer(room.room().rig, map, {});
  PoseEstimate estimate;
  FrameSetLease set = room.set(0);
  localizer.localize(set, estimate);
  EXPECT_TRUE(estimate.protection.of_cameras);
  // A map of two of the markers that are seen.
  std::erase_if(map.submaps[0].markers, [&](const MapMarker& marker) {
    return marker.id != estimate.observations[0].marker &&
           marker.id != estimate.observations[1].marker;
  });
  ASSERT_EQ(map.submaps[0].markers.size(), 2U);
  Rig one = room.room().rig;
  one.cameras.erase(one.cameras.begin() + 1, one.cameras.end());
  Localizer of_two(one, map, {});
  of_two.localize(room.set(0), estimate);
  if (estimate.has_pose()) {
    EXPECT_FALSE(estimate.protection.finite());
    EXPECT_FALSE(estimate.protection.of_cameras);
  }
}

}  // namespace
}  // namespace waymark
