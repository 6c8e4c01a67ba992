#include "mapbuilder/diagnosis/unsynchronized.h"

#include <gtest/gtest.h>

#include "tests/mapbuilder/diagnosis/simulated_tracks.h"

namespace waymark::tests {
namespace {

/// Tracks of a rig whose camera `free` takes its images at moments that scatter by so much.
CameraTracks free_running(const SimulatedDrive& drive, const Extrinsics& truth, std::size_t free,
                          double scatter_s) {
  CameraTracks tracks = drive_tracks(drive, truth);
  std::mt19937 random(drive.seed + 7);
  std::normal_distribution<double> normal(0, scatter_s);
  for (int i = 0; i < drive.instants; ++i) {
    auto& place = tracks.instants[static_cast<std::size_t>(i)].places[free];
    if (!place) continue;
    const double time_s = drive.period_s * i;
    const Rigid3 noise =
        place->world_from_cam * (driven_pose(drive, time_s) * truth[free]).inverse();
    place->world_from_cam = noise * driven_pose(drive, time_s + normal(random)) * truth[free];
  }
  return tracks;
}

TEST(UnsynchronizedCameras, AShutterThatRunsFreeIsToldWithItsScatter) {
  int right = 0;
  int all = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    for (const double scatter_s : {0.012, 0.02, 0.03}) {
      SimulatedDrive drive;
      drive.seed = seed;
      drive.instants = 80;
      drive.gross_share = 0.02;
      const Extrinsics truth = ring_of_cameras(2 + seed % 3, 60);
      const std::size_t free = truth.size() - 1;
      const auto found = unsynchronized_cameras(free_running(drive, truth, free, scatter_s), truth);
      ++all;
      right += found.size() == 1 && found[0].camera == free &&
                       std::abs(found[0].scatter_s / scatter_s - 1) < 0.4
                   ? 1
                   : 0;
    }
  }
  EXPECT_GE(20 * right, 19 * all);
}

TEST(UnsynchronizedCameras, ShuttersThatAreTogetherAreNotAccused) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SimulatedDrive drive;
    drive.seed = seed;
    const Extrinsics truth = ring_of_cameras(2 + seed % 3, 60);
    EXPECT_TRUE(unsynchronized_cameras(drive_tracks(drive, truth), truth).empty());
  }
}

TEST(UnsynchronizedCameras, ARigThatMerelyIsAnotherIsNotAccused) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SimulatedDrive drive;
    drive.seed = seed;
    const Extrinsics truth = ring_of_cameras(3, 60);
    Extrinsics stated = truth;
    stated[2] = truth[2] * turned_by(2, Eigen::Vector3d(1, 2, 3), {0.02, -0.01, 0.03});
    EXPECT_TRUE(unsynchronized_cameras(drive_tracks(drive, truth), stated).empty());
  }
}

}  // namespace
}  // namespace waymark::tests
