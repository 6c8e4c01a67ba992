#include <random>

#include "core/camera/lens_kind.h"
#include "mapbuilder/build/map_builder.h"
#include "tests/mapbuilder/observations/room_observations.h"
#include "tests/support/other_lens.h"

namespace waymark {
namespace {

constexpr double kNoise_px = 0.2;

test::SyntheticRoom noisy_room(int cameras = 3) {
  test::RoomOptions options;
  options.noise_px = kNoise_px;
  options.cameras = cameras;
  return test::make_room(options);
}

BuildResult build(const Observations& observations, const BuildOptions& options) {
  Progress progress(false);
  return build_map(Selection(observations), options, progress);
}

MarkerPlace centre_of(const Observations& observations, std::size_t marker) {
  return {observations.markers[MarkerIndex(marker)], std::nullopt};
}

Eigen::Vector3d true_centre(const test::SyntheticRoom& room, const Observations& observations,
                            std::size_t marker) {
  const int number = observations.markers[MarkerIndex(marker)].number;
  return room.world_from_marker[static_cast<std::size_t>(number)].translation;
}

TEST(Refinement, FindsTrueExtrinsicsAndSaysHowFarTheyWereOff) {
  auto room = noisy_room();
  const Rigid3 truth = room.rig.cameras[1].rig_from_cam;
  Vector6d off;
  off << 0.02, -0.01, 0.005, 0.01, 0.005, -0.008;
  room.rig.cameras[1].rig_from_cam = truth.plus(off);
  const auto observations = test::observations_of(room);
  BuildOptions options;
  options.refine.extrinsics = true;
  const BuildResult result = build(observations, options);
  ASSERT_EQ(result.submaps.size(), 1U);
  const CalibrationResult& calibration = result.calibration;
  ASSERT_TRUE(calibration.refined);
  const Vector6d left =
      result.estimate.calibration.rigs.front().cameras[1].rig_from_cam.minus(truth);
  const CameraUncertainty& sure = calibration.uncertainty.cameras[CameraIndex(1)];
  EXPECT_LT(left.head<3>().norm(), 5 * std::sqrt(3.0) * sure.position_m);
  EXPECT_LT(left.tail<3>().norm(), 5 * std::sqrt(3.0) * sure.rotation_rad);
  EXPECT_LT(sure.position_m, 0.002);
  EXPECT_GT(sure.position_m, 1e-5) << "nothing is known for nothing";
}

TEST(Refinement, FindsTrueIntrinsics) {
  auto room = noisy_room(1);
  CameraParameters stated = room.rig.cameras[0].model.parameters();
  const double true_fu = stated.fu_px;
  stated.fu_px *= 1.006;
  stated.fv_px *= 1.006;
  room.rig.cameras[0].model = *CameraModel::create(stated);
  const auto observations = test::observations_of(room);
  BuildOptions options;
  options.refine.intrinsics = true;
  const BuildResult result = build(observations, options);
  const CalibrationResult& calibration = result.calibration;
  ASSERT_TRUE(calibration.refined);
  EXPECT_NEAR(
      result.estimate.calibration.rigs.front().cameras[0].model.parameters().fu_px / true_fu, 1.0,
      5 * std::max(1e-4, calibration.uncertainty.cameras.front().focal));
}

TEST(Refinement, FindsK3AndEucmFromZeroDistortion) {
  const std::pair<Distortion, LensCoefficients> kLenses[] = {
      {Distortion::radtan5, {-0.2, 0.06, 0.0005, -0.0005, -0.005}}, {Distortion::eucm, {0.6, 1.1}}};
  for (const auto& [distortion, coefficients] : kLenses) {
    auto room = noisy_room(1);
    CameraParameters truth = room.rig.cameras[0].model.parameters();
    truth.distortion = distortion;
    truth.coefficients = coefficients;
    truth.fu_px = truth.fv_px = 640 / focal_share_at_axis(truth);
    room = test::taken_by(std::move(room), truth);
    CameraParameters stated = truth;
    stated.coefficients = plain_coefficients(distortion);
    stated.fu_px = stated.fv_px = 1.05 * 640;
    room.rig.cameras[0].model = *CameraModel::create(stated);
    const auto observations = test::observations_of(room);
    BuildOptions options;
    options.refine.intrinsics = true;
    const BuildResult result = build(observations, options);
    const CameraModel& found = result.estimate.calibration.rigs.front().cameras[0].model;
    EXPECT_TRUE(result.calibration.refined) << to_string(distortion);
    EXPECT_LT(test::apart_px(truth, found.parameters()), 3) << to_string(distortion);
  }
}

TEST(Refinement, ACameraThatSeesNothingStaysAsStatedAndHoldsUpNobody) {
  auto room = noisy_room();
  const Rigid3 truth = room.rig.cameras[1].rig_from_cam;
  Vector6d off;
  off << 0.02, -0.01, 0.005, 0.01, 0.005, -0.008;
  room.rig.cameras[1].rig_from_cam = truth.plus(off);
  for (ImageDetections& image : room.images) {
    if (image.camera == 2) image.detections.clear();
  }
  const Rigid3 unseen = room.rig.cameras[2].rig_from_cam;
  const auto observations = test::observations_of(room);
  BuildOptions options;
  options.refine.extrinsics = true;
  const BuildResult result = build(observations, options);
  ASSERT_TRUE(result.calibration.refined);
  const Vector6d left =
      result.estimate.calibration.rigs.front().cameras[1].rig_from_cam.minus(truth);
  EXPECT_LT(left.head<3>().norm(), 0.005);
  EXPECT_EQ(result.estimate.calibration.rigs.front().cameras[2].rig_from_cam.translation,
            unseen.translation);
  EXPECT_EQ(result.estimate.calibration.rigs.front().cameras[2].rig_from_cam.rotation.coeffs(),
            unseen.rotation.coeffs());
}

TEST(Refinement, OfOneCamerasExtrinsicsIsRefusedAndTheMapUnharmed) {
  const auto room = noisy_room(1);
  const auto plain_observations = test::observations_of(room);
  const BuildResult plain = build(plain_observations, {});
  const auto observations = test::observations_of(room);
  BuildOptions options;
  options.refine.extrinsics = true;
  const BuildResult result = build(observations, options);
  const CalibrationResult& calibration = result.calibration;
  EXPECT_FALSE(calibration.refined);
  ASSERT_FALSE(calibration.refused.empty());
  EXPECT_NE(calibration.refused[0].find("one camera"), std::string::npos);
  for (std::size_t m = 0; m < plain.submaps[0].map.markers.size(); ++m) {
    EXPECT_EQ(result.submaps[0].map.markers[m].world_from_marker.translation,
              plain.submaps[0].map.markers[m].world_from_marker.translation);
  }
}

TEST(Refinement, OfSizesWithoutAMeasuredLengthIsRefused) {
  const auto room = noisy_room(1);
  const auto observations = test::observations_of(room);
  BuildOptions options;
  options.refine.sizes = true;
  const BuildResult result = build(observations, options);
  EXPECT_FALSE(result.calibration.refused.empty());
  EXPECT_EQ(result.estimate.calibration.sizes_m, observations.stated_sizes_m);
}

TEST(RigCheck, ARigThatFitsExplainsNothingMoreWhenFreedAndOneThatDoesNotDoes) {
  auto room = noisy_room();
  const auto observations = test::observations_of(room);
  const BuildResult fits = build(observations, {});
  EXPECT_GT(fits.calibration.extrinsics_cost_ratio, kExplainsTooLittle);
  EXPECT_GT(fits.calibration.intrinsics_cost_ratio, kExplainsTooLittle);

  Vector6d off;
  off << 0.01, 0, 0, 0, 0.006, 0;
  room.rig.cameras[2].rig_from_cam = room.rig.cameras[2].rig_from_cam.plus(off);
  const auto bent = test::observations_of(room);
  const BuildResult misfit = build(bent, {});
  EXPECT_LT(misfit.calibration.extrinsics_cost_ratio, kExplainsTooLittle);
  EXPECT_EQ(misfit.estimate.calibration.rigs.front().cameras[2].rig_from_cam.translation,
            room.rig.cameras[2].rig_from_cam.translation)
      << "a trial changes nothing";
}

TEST(SurveyedBuild, ADistanceCorrectsTheScaleOfWrongSizes) {
  auto room = noisy_room(1);
  // Stated 0.8 % too large: the map would be 0.8 % too large.
  constexpr double kStatedTooLarge = 1.008;
  room.catalog = MarkerCatalog({{room.catalog.entries()[0].family,
                                 *room.catalog.entries()[0].default_size_m * kStatedTooLarge,
                                 {},
                                 {}}});
  const auto observations = test::observations_of(room);
  const double distance_m =
      (true_centre(room, observations, 0) - true_centre(room, observations, 20)).norm();
  const double check_m =
      (true_centre(room, observations, 5) - true_centre(room, observations, 30)).norm();
  BuildOptions options;
  options.survey.distances = {
      {centre_of(observations, 0), centre_of(observations, 20), distance_m, 0.001, SurveyUse::fit},
      {centre_of(observations, 5), centre_of(observations, 30), check_m, 0.001, SurveyUse::check}};
  const BuildResult result = build(observations, options);
  const BuiltSubMap& submap = result.submaps.at(0);
  EXPECT_EQ(submap.map.frame, FrameKind::scaled);
  ASSERT_EQ(submap.survey.size(), 2U);
  EXPECT_LT(std::abs(submap.survey[0].residual_m), 0.003);
  EXPECT_LT(std::abs(submap.survey[1].residual_m), 0.02);
  EXPECT_LT(std::abs(submap.survey[1].residual_m), 0.35 * check_m * (kStatedTooLarge - 1.0));
}

TEST(SurveyedBuild, ThreePointsGiveTheFacilityFrame) {
  const auto room = noisy_room();
  const auto observations = test::observations_of(room);
  const Rigid3 facility_from_world{so3_exp(Eigen::Vector3d(0.1, -0.2, 1.0)), {100, -20, 3}};
  BuildOptions options;
  for (const std::size_t m : {0U, 13U, 27U, 35U}) {
    options.survey.points.push_back({centre_of(observations, m),
                                     facility_from_world * true_centre(room, observations, m),
                                     0.001, m == 35U ? SurveyUse::check : SurveyUse::fit});
  }
  const BuildResult result = build(observations, options);
  const SubMap& map = result.submaps.at(0).map;
  EXPECT_EQ(map.frame, FrameKind::facility);
  for (std::size_t m = 0; m < map.markers.size(); ++m) {
    const Eigen::Vector3d truth = facility_from_world * true_centre(room, observations, m);
    const Eigen::Vector3d off = map.markers[m].world_from_marker.translation - truth;
    EXPECT_LT(off.norm(), 0.01);
    // In the survey's gauge: nothing is known better than three points of 1 mm tell, and errors
    // stay within their own sigmas.
    const Eigen::Matrix3d covariance = map.markers[m].covariance.topLeftCorner<3, 3>();
    EXPECT_GT(covariance.trace(), 1e-7);
    EXPECT_LT(off.dot(covariance.inverse() * off), 25.0);
  }
  EXPECT_LT(result.submaps[0].survey[3].residual_m, 0.01);
}

TEST(SurveyedBuild, TwoPointsDoNot) {
  const auto room = noisy_room();
  const auto observations = test::observations_of(room);
  BuildOptions options;
  for (const std::size_t m : {0U, 13U}) {
    options.survey.points.push_back(
        {centre_of(observations, m), true_centre(room, observations, m), 0.001, SurveyUse::fit});
  }
  const BuildResult result = build(observations, options);
  EXPECT_EQ(result.submaps.at(0).map.frame, FrameKind::arbitrary);
  EXPECT_FALSE(result.submaps[0].survey[0].mapped);
}

}  // namespace
}  // namespace waymark
