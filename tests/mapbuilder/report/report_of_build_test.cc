#include "mapbuilder/report/report_of_build.h"

#include <gtest/gtest.h>

#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

/// A room built from its detections, with the truth carried elsewhere.
class ReportOfBuild : public testing::Test {
 protected:
  static test::RoomOptions options() {
    test::RoomOptions options;
    options.noise_px = 0.2;
    options.markers = 24;
    options.frame_sets = 30;
    return options;
  }

  Report report(bool mono, Rigid3 truth_from_world = {}) {
    observations = test::observations_of(room, {mono, 1});
    BuildOptions build;
    build.threads = 1;
    Progress progress;
    result = build_map(Selection(observations), build, progress);
    CaptureTruth truth{"room", room.rig, {}};
    for (std::size_t i = 0; i < room.world_from_rig.size(); ++i) {
      truth.world_from_rig.push_back(
          {test::room_stamp(static_cast<int>(i)), truth_from_world * room.world_from_rig[i]});
    }
    return report_of_build(result, observations, {truth});
  }

  test::SyntheticRoom room = test::make_room(options());
  Observations observations;
  BuildResult result;
};

TEST_F(ReportOfBuild, TellsEveryObservationWithItsResidual) {
  const Report told = report(false);
  ASSERT_EQ(told.submaps.size(), 1U);
  ASSERT_EQ(told.cameras.size(), 3U);
  EXPECT_EQ(told.cameras[2].name, "cam2");
  EXPECT_EQ(told.observations.size(), observations.usable);
  double squared = 0;
  for (const ReportObservation& o : told.observations) {
    EXPECT_TRUE(o.accepted);
    for (const auto& residual : o.residuals_px) squared += residual.squaredNorm();
  }
  const double rms_px = std::sqrt(squared / (4.0 * static_cast<double>(told.observations.size())));
  EXPECT_NEAR(rms_px, result.map.submaps[0].rms_px, 1e-9);
  EXPECT_NEAR(rms_px, 0.2 * std::sqrt(2.0), 0.03);
}

TEST_F(ReportOfBuild, LaysTheTruthBesideTheTrack) {
  const Report told = report(false, {so3_exp({1, 2, -0.5}), {100, 20, -7}});
  ASSERT_EQ(told.submaps[0].tracks.size(), 1U);
  const ReportTrack& track = told.submaps[0].tracks[0];
  EXPECT_FALSE(track.camera);
  ASSERT_EQ(track.poses.size(), 30U);
  ASSERT_EQ(track.true_poses.size(), 30U);
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_LT((track.poses[i].pose.translation - track.true_poses[i].pose.translation).norm(),
              0.01);
  }
  ASSERT_TRUE(track.rmse_to_true);
  EXPECT_GT(track.rmse_to_true->translation_m, 1e-6);
  EXPECT_LT(track.rmse_to_true->translation_m, 0.005);
}

TEST_F(ReportOfBuild, OfAMonoBuildEachCameraHasATrackBesideItsOwnTruth) {
  const Report told = report(true);
  ASSERT_EQ(told.submaps[0].tracks.size(), 3U);
  for (const ReportTrack& track : told.submaps[0].tracks) {
    ASSERT_TRUE(track.camera);
    ASSERT_EQ(track.true_poses.size(), 30U);
    for (const StampedPose& pose : track.poses) {
      const auto truth =
          std::find_if(track.true_poses.begin(), track.true_poses.end(),
                       [&](const StampedPose& candidate) { return candidate.stamp == pose.stamp; });
      ASSERT_NE(truth, track.true_poses.end());
      EXPECT_LT((pose.pose.translation - truth->pose.translation).norm(), 0.03);
    }
  }
}

TEST_F(ReportOfBuild, KnowsWhereTheCamerasUpPoints) {
  const Report told = report(false);
  const Eigen::Vector3d up = told.submaps[0].camera_up_in_world;
  EXPECT_GT(up.norm(), 0.9);
  // The room's truth stands upright; so does the track's, carried into the map.
  const Rigid3& world_from_rig = told.submaps[0].tracks[0].true_poses[0].pose;
  const Eigen::Vector3d z_in_rig =
      room.world_from_rig[0].rotation.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_GT((world_from_rig.rotation * z_in_rig).dot(up.normalized()), 0.99);
}

TEST_F(ReportOfBuild, WithoutTruthThereIsNone) {
  (void)report(false);
  const Report told = report_of_build(result, observations, {});
  EXPECT_TRUE(told.submaps[0].tracks[0].true_poses.empty());
  EXPECT_FALSE(told.submaps[0].tracks[0].rmse_to_true);
}

}  // namespace
}  // namespace waymark
