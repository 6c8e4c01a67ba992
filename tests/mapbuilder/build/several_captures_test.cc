#include "core/geometry/tum.h"
#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/build/trajectory_file.h"
#include "tests/mapbuilder/observations/room_observations.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

/// Two walks through one room at the very same stamps, as of two days with clocks that start anew.
struct TwoDays {
  test::SyntheticRoom monday;
  test::SyntheticRoom tuesday;
};

TwoDays two_days() {
  test::RoomOptions options;
  options.noise_px = 0.2;
  TwoDays days;
  days.monday = test::make_room(options);
  options.frame_sets = 45;  // another way round, other noise, the same markers
  days.tuesday = test::make_room(options);
  return days;
}

Observations observations_of(const TwoDays& days) {
  auto observations = make_observations(
      {test::capture_of(days.monday, "monday"), test::capture_of(days.tuesday, "tuesday")}, {});
  EXPECT_TRUE(observations) << observations.error().message;
  return std::move(*observations);
}

BuildResult build(const Observations& observations, const BuildOptions& options = {}) {
  Progress progress(false);
  return build_map(Selection(observations), options, progress);
}

TEST(SeveralCaptures, StampsThatOverlapAreKeptApart) {
  const TwoDays days = two_days();
  Observations observations = observations_of(days);
  EXPECT_EQ(observations.frame_sets.size(), 60U + 45U);
  const BuildResult result = build(observations);
  ASSERT_EQ(result.submaps.size(), 1U);
  EXPECT_EQ(result.submaps[0].trajectory.size(), 60U + 45U);

  const test::TemporaryFolder folder;
  ASSERT_TRUE(
      write_trajectory(folder.path() / "out.tum", 0, observations, result.submaps[0].trajectory));
  // The first that was given has the named file, whatever the canonical order.
  const auto monday = read_tum(folder.path() / "out.tum");
  const auto tuesday = read_tum(folder.path() / "out.capture1.tum");
  ASSERT_TRUE(monday && tuesday);
  ASSERT_EQ(monday->size(), 60U);
  ASSERT_EQ(tuesday->size(), 45U);
  // Each pose is its own day's: against each other they stand as the true ones do.
  const Rigid3 map_from_room = (*monday)[0].pose * days.monday.world_from_rig[0].inverse();
  for (std::size_t i = 0; i < 45; ++i) {
    const Vector6d off = (*tuesday)[i].pose.minus(map_from_room * days.tuesday.world_from_rig[i]);
    EXPECT_LT(off.head<3>().norm(), 0.02) << i;
  }
}

TEST(SeveralCaptures, OneWithoutAPoseHasAnEmptyFile) {
  const TwoDays days = two_days();
  const Observations observations = observations_of(days);
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_trajectory(folder.path() / "out.tum", 1, observations, {}));
  EXPECT_EQ(folder.read("out.1.tum"), format_tum({}));
  EXPECT_EQ(folder.read("out.capture1.1.tum"), format_tum({}));
}

TEST(SharedRig, IsRefinedOnceForAllCapturesOfTheSameCameras) {
  TwoDays days = two_days();
  const Rigid3 truth = days.monday.rig.cameras[1].rig_from_cam;
  Vector6d off;
  off << 0.01, -0.01, 0.005, 0.01, 0.005, -0.008;
  for (auto* room : {&days.monday, &days.tuesday}) {
    room->rig.cameras[1].rig_from_cam = truth.plus(off);
  }
  Observations observations = observations_of(days);
  ASSERT_EQ(observations.rigs.size(), 1U);
  BuildOptions options;
  options.refine.extrinsics = true;
  const BuildResult result = build(observations, options);
  ASSERT_TRUE(result.calibration.refined);
  EXPECT_EQ(result.calibration.uncertainty.cameras.size(), 3U);
  ASSERT_EQ(observations.rigs.size(), 1U);
  const CameraUncertainty& both = result.calibration.uncertainty.cameras[CameraIndex(1)];
  const Vector6d left =
      result.estimate.calibration.rigs.front().cameras[1].rig_from_cam.minus(truth);
  EXPECT_LT(left.head<3>().norm(), 5 * std::sqrt(3.0) * both.position_m);
  EXPECT_LT(left.tail<3>().norm(), 5 * std::sqrt(3.0) * both.rotation_rad);

  // What one day alone tells is less.
  const Observations alone = test::observations_of(days.monday);
  const BuildResult one = build(alone, options);
  ASSERT_TRUE(one.calibration.refined);
  EXPECT_LT(both.position_m, one.calibration.uncertainty.cameras[CameraIndex(1)].position_m);
}

TEST(SharedRig, SerialsThatDifferKeepEqualNumbersApart) {
  TwoDays days = two_days();
  EXPECT_EQ(observations_of(days).rigs.size(), 1U);
  days.monday.rig.cameras[0].serial = "A1";
  EXPECT_EQ(observations_of(days).rigs.size(), 1U) << "one states none: nothing says otherwise";
  days.tuesday.rig.cameras[0].serial = "B7";
  const Observations observations = observations_of(days);
  EXPECT_EQ(observations.rigs.size(), 2U);
  EXPECT_TRUE(observations.recalibrated.empty());
}

TEST(SharedRig, OtherNumbersOfTheSameCamerasAreKeptApartAndNamed) {
  TwoDays days = two_days();
  for (auto* room : {&days.monday, &days.tuesday}) {
    for (RigCamera& camera : room->rig.cameras) camera.serial = "serial of " + camera.name;
  }
  days.tuesday.rig.cameras[2].rig_from_cam.translation.x() += 0.001;
  const Observations observations = observations_of(days);
  EXPECT_EQ(observations.rigs.size(), 2U);
  ASSERT_EQ(observations.recalibrated.size(), 1U);
  EXPECT_EQ(observations.recalibrated[0].first, "monday");
  EXPECT_EQ(observations.recalibrated[0].second, "tuesday");
}

}  // namespace
}  // namespace waymark
