#include "mapbuilder/diagnosis/rig_agreement.h"

#include <gtest/gtest.h>

#include "tests/mapbuilder/diagnosis/simulated_tracks.h"

namespace waymark {
namespace {

using tests::drive_tracks;
using tests::driven_pose;
using tests::ring_of_cameras;
using tests::SimulatedDrive;

TEST(RigAgreement, MostCamerasDecideAndOneThatIsFarOffCountsBounded) {
  SimulatedDrive drive;
  drive.missing_share = 0;
  drive.gross_share = 0;
  const Extrinsics rig = ring_of_cameras(4, 85);
  CameraTracks tracks = drive_tracks(drive, rig);
  for (std::size_t i = 0; i < tracks.instants.size(); ++i) {
    auto& instant = tracks.instants[i];
    const Rigid3 truth = driven_pose(drive, drive.period_s * static_cast<double>(i));
    const InstantAgreement sound = agree(instant, rig, 1.0);
    EXPECT_LT(sound.world_from_rig->minus(truth).norm(), 0.005);
    EXPECT_EQ(sound.cameras, 4);
    instant.places[i % 4]->world_from_cam.translation += Eigen::Vector3d(0.4, -0.2, 0.1);
    const InstantAgreement outvoted = agree(instant, rig, 1.0);
    EXPECT_LT(outvoted.world_from_rig->minus(truth).norm(), 0.01);
    EXPECT_NEAR(outvoted.cost, sound.cost + 36.0, 25.0);
    EXPECT_EQ(agree(instant, rig, 1.0, static_cast<int>(i % 4)).cameras, 3);
  }
}

TEST(RigAgreement, OneCameraAgreesWithItselfAndNoneWithNobody) {
  CameraTracks::Instant instant;
  instant.places.resize(2);
  EXPECT_FALSE(agree(instant, ring_of_cameras(2, 60), 1.0).world_from_rig);
  instant.places[1] = TrackedPlace{Rigid3{}, Matrix6d::Identity()};
  const InstantAgreement alone = agree(instant, ring_of_cameras(2, 60), 1.0);
  ASSERT_TRUE(alone.world_from_rig);
  EXPECT_NEAR(alone.cost, 0, 1e-9);
}

TEST(RigAgreement, TheLossIsBoundedAtSixSigmas) {
  EXPECT_NEAR(bounded_misfit(0.01), 0.01, 1e-5);
  EXPECT_LT(bounded_misfit(1e9), 36.0001);
}

}  // namespace
}  // namespace waymark
