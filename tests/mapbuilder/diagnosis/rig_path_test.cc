#include "mapbuilder/diagnosis/rig_path.h"

#include <gtest/gtest.h>

#include "tests/mapbuilder/diagnosis/simulated_tracks.h"

namespace waymark {
namespace {

using tests::drive_tracks;
using tests::driven_pose;
using tests::ring_of_cameras;
using tests::SimulatedDrive;

TEST(RigPath, FollowsTheDriveBetweenFrameSets) {
  SimulatedDrive drive;
  drive.gross_share = 0;  // two cameras can't outvote each other
  const Extrinsics rig = ring_of_cameras(3, 60);
  const RigPath path(drive_tracks(drive, rig), rig, 1.0, 1);
  EXPECT_TRUE(path.moves());
  EXPECT_NEAR(path.period_s(), drive.period_s, 1e-6);
  int judged = 0;
  for (const std::size_t i : {10U, 20U, 30U}) {
    for (const double offset : {-0.13, -0.05, 0.04, 0.17}) {
      const auto motion = path.motion(i, offset);
      if (!motion || !path.at(i)) continue;
      const double time_s = drive.period_s * static_cast<double>(i);
      const Rigid3 truth =
          driven_pose(drive, time_s + offset) * driven_pose(drive, time_s).inverse();
      EXPECT_LT((*motion * *path.at(i)).minus(truth * *path.at(i)).norm(), 0.02);
      ++judged;
    }
  }
  EXPECT_GT(judged, 6);
}

TEST(RigPath, PlacesHereAndThereAreNoPath) {
  SimulatedDrive drive;
  const Extrinsics rig = ring_of_cameras(3, 60);
  CameraTracks tracks = drive_tracks(drive, rig);
  // Positions in no order, as of a camera that is carried from spot to spot.
  for (std::size_t i = 0; i < tracks.instants.size(); ++i) {
    std::swap(tracks.instants[i].places, tracks.instants[(i * 17) % tracks.instants.size()].places);
  }
  EXPECT_FALSE(RigPath(tracks, rig, 1.0, -1).moves());
}

TEST(RigPath, AGapIsNotBridged) {
  SimulatedDrive drive;
  drive.gross_share = 0;
  const Extrinsics rig = ring_of_cameras(2, 60);
  CameraTracks tracks = drive_tracks(drive, rig);
  for (std::size_t i = 10; i < 20; ++i) {
    for (auto& place : tracks.instants[i].places) place.reset();
  }
  const RigPath path(tracks, rig, 1.0, -1);
  EXPECT_FALSE(path.at(15));
  EXPECT_FALSE(path.motion(9, 0.3));
}

}  // namespace
}  // namespace waymark
