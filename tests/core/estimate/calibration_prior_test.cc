#include "core/estimate/calibration_prior.h"

#include <gtest/gtest.h>

#include "core/camera/rig_fingerprint.h"
#include "core/estimate/consider_parameters.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

Rig rig() {
  Rig rig = test::ring_rig(2);
  for (RigCamera& camera : rig.cameras) camera.stated_sigmas = {};
  rig.cameras[1].stated_sigmas.focal = 0.004;
  return rig;
}

/// Of two sizes; considers everything of the rig, each mode a share of one number.
SubMap considered_map(const Rig& rig) {
  SubMap map;
  for (const double size_m : {0.3, 0.1, 0.3}) {
    MapMarker& marker = map.markers.emplace_back();
    marker.stated_size_m = marker.size_m = size_m;
    marker.modes(0, 0) = 0.001F;
  }
  const ConsiderParameters all =
      consider_parameters(std::span(&rig, 1), std::vector<StatedSize>{{0.1, 0.002}, {0.3, 0.001}});
  for (const ConsiderParameter& one : all.all) {
    map.parameters.push_back({name_of(one, std::span(&rig, 1)), "", {}});
  }
  map.parameter_covariance = 0.25 * all.covariance;
  // The first mode is the error of the 0.1 m prints, half of whose variance is common to all; the
  // second half the first number's.
  const Eigen::Index small = all.count() - 2;
  const auto sigma = [&](Eigen::Index i) { return std::sqrt(map.parameter_covariance(i, i)); };
  map.parameters[static_cast<std::size_t>(small)].cross[0] = sigma(small);
  map.parameters[static_cast<std::size_t>(small) + 1].cross[0] = 0.5 * sigma(small + 1);
  map.parameters[0].cross[1] = 0.5 * sigma(0);
  return map;
}

TEST(CalibrationPrior, IsWhatTheRigStatesAndElseTheDefaults) {
  SubMap map;
  map.markers.emplace_back().stated_size_m = 0.3;
  const CalibrationPrior prior(rig(), {}, map, false);
  EXPECT_EQ(prior.cameras(), 2U);
  EXPECT_EQ(prior.sizes(), 1U);
  EXPECT_EQ(prior.modes(), 0);
  EXPECT_EQ(prior.size(), 2 * kCalibrationNumbers + 1);
  EXPECT_NEAR(std::sqrt(prior.variances_of(0)[kFocal]), 0.001, 1e-7);
  EXPECT_NEAR(std::sqrt(prior.variances_of(1)[kFocal]), 0.004, 1e-7);
  EXPECT_NEAR(std::sqrt(prior.variances_of(1)[kEdge]), 0.2, 1e-6);
  EXPECT_NEAR(std::sqrt(prior.variances_of(1)[kReadout]), 0.005, 1e-7);
  EXPECT_NEAR(std::sqrt(prior.size_variance(0)), 0.001, 1e-7);
  const Eigen::Index edge = CalibrationPrior::first_of(1) + kEdge;
  EXPECT_NEAR(prior.covariance()(kEdge, edge), 0.5 * prior.covariance()(edge, edge), 1e-9);
}

TEST(CalibrationPrior, PrintsErrAsTheMapThatIsMadeOfThemDoes) {
  const SubMap map = considered_map(rig());
  const CalibrationPrior prior(rig(), {}, map, false);
  EXPECT_EQ(prior.modes(), kMapModes);
  EXPECT_EQ(prior.size_of(map.markers[0]), 1U);
  EXPECT_EQ(prior.size_of(map.markers[1]), 0U);
  EXPECT_NEAR(std::sqrt(prior.size_variance(0)), 0.5 * 0.002, 1e-7);
  const Eigen::Index mode = prior.numbers();
  EXPECT_NEAR(prior.covariance()(prior.at_size(0), mode) /
                  std::sqrt(prior.covariance()(prior.at_size(0), prior.at_size(0))),
              1, 1e-6);
  // Another calibration's cameras: their own sigmas, nothing in common.
  EXPECT_NEAR(std::sqrt(prior.variances_of(0)[kFocal]), 0.001, 1e-7);
  EXPECT_EQ(prior.covariance().topRightCorner(2 * kCalibrationNumbers, kMapModes).norm(), 0);
}

TEST(CalibrationPrior, OfTheMapsOwnCalibrationCamerasErrAsItsMarkersDo) {
  const SubMap map = considered_map(rig());
  const CalibrationPrior prior(rig(), {}, map, true);
  EXPECT_NEAR(std::sqrt(prior.variances_of(0)[kFocal]), 0.5 * 0.001, 1e-7);
  EXPECT_GT(prior.covariance().topRightCorner(2 * kCalibrationNumbers, kMapModes).norm(), 0.1);
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(prior.covariance()).info(), Eigen::Success);
}

TEST(CalibrationPrior, EdgesThatTheMapAloneMeasuredAreTheRigsOwn) {
  for (const double sigma_px : {0.005, 0.01, 0.05, 0.1, 0.2}) {
    SubMap map = considered_map(rig());
    const auto edge = std::find_if(map.parameters.begin(), map.parameters.end(),
                                   [](const auto& one) { return one.name == "cam0 edge bias"; });
    ASSERT_NE(edge, map.parameters.end());
    const auto at = edge - map.parameters.begin();
    map.parameter_covariance.row(at).setZero();
    map.parameter_covariance.col(at).setZero();
    map.parameter_covariance(at, at) = sigma_px * sigma_px;
    const bool measured = sigma_px < 0.08;
    EXPECT_EQ(knows_edges_better(map, rig(), 0), measured) << sigma_px;
    const CalibrationPrior prior(rig(), {}, map, true);
    EXPECT_NEAR(std::sqrt(prior.variances_of(0)[kEdge]), measured ? 0.2 : sigma_px, 1e-5);
    EXPECT_NEAR(std::sqrt(prior.variances_of(0)[kFocal]), 0.5 * 0.001, 1e-7);
    EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(prior.covariance()).info(), Eigen::Success);
    Rig stating = rig();
    state_sigma(0, CameraQuantity::edge, sigma_px, stating);
    EXPECT_FALSE(knows_edges_better(map, stating, 0)) << "the rig that states what was measured";
  }
}

TEST(CalibrationPrior, IsOfTheMapOnlyWhereNumbersAndSerialsAre) {
  const SubMap map = considered_map(rig());
  const std::string of_rig = fingerprint(rig());
  EXPECT_TRUE(is_calibration_of(map, of_rig, rig()));
  EXPECT_FALSE(is_calibration_of(map, "0123456789abcdef", rig()));
  EXPECT_FALSE(is_calibration_of(map, "", rig()));
  Rig stated = rig();
  stated.cameras[1].serial = "42";
  EXPECT_FALSE(is_calibration_of(map, of_rig, stated));
  SubMap by_hand = map;
  by_hand.parameters.clear();
  EXPECT_FALSE(is_calibration_of(by_hand, of_rig, rig()));
}

TEST(CalibrationPrior, SizesMayBeExact) {
  SubMap map = considered_map(rig());
  state_exact_sizes(map);
  ASSERT_EQ(map.parameters.size(), 2U);
  const CalibrationPrior prior(test::ring_rig(2), {}, map, false);
  EXPECT_LT(prior.size_variance(0), 1e-15);
  EXPECT_LT(prior.variances_of(1).maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace waymark
