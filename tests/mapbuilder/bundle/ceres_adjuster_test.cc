#include "mapbuilder/bundle/ceres_adjuster.h"

#include "mapbuilder/bundle/bundle_adjustment.h"
#include "tests/mapbuilder/bundle/bundle_of_room.h"

namespace waymark {
namespace {

struct Variant {
  const char* name;
  ObservationLoss loss;
  VariableCalibration variable;
  bool surveyed = false;
};

/// A room with noise, a few observations far off, and a rig whose file is a little wrong.
class CeresAdjuster : public testing::TestWithParam<Variant> {
 protected:
  static test::SyntheticRoom noisy_room() {
    test::RoomOptions options;
    options.noise_px = 0.3;
    options.markers = 24;
    options.frame_sets = 30;
    test::SyntheticRoom room = test::make_room(options);
    Vector6d off;
    off << 0.01, -0.005, 0, 0, 0.004, 0.002;
    RigCamera& camera = room.rig.cameras[1];
    camera.rig_from_cam = camera.rig_from_cam.plus(off);
    return room;
  }

  static void disturb(Observations& observations) {
    for (std::size_t i = 0; i < observations.usable; i += 37) {
      observations.all[ObservationIndex(i)].corners_px[1] += Eigen::Vector2d(6, -4);
    }
  }

  [[nodiscard]] BundleProblem problem() {
    BundleProblem problem = test::bundle_of(known);
    problem.loss = GetParam().loss;
    problem.scope.variable = GetParam().variable;
    if (GetParam().surveyed) {
      const auto centre = [&](std::size_t m) {
        return MarkerPlace{known.observations.markers[MarkerIndex(m)], std::nullopt};
      };
      const double true_m =
          (room.world_from_marker[0].translation - room.world_from_marker[12].translation).norm();
      survey.distances = {{centre(0), centre(12), 1.001 * true_m, 0.001, SurveyUse::fit}};
      problem.scope.survey = &survey;
    }
    return problem;
  }

  test::SyntheticRoom room = noisy_room();
  test::PreparedRoom known{room, disturb};
  Survey survey;
};

TEST_P(CeresAdjuster, FindsTheOwnSolversOptimum) {
  BundleOptions options{.max_iterations = 200, .function_tolerance = 1e-13};
  const BundleSolution own = adjust(problem(), options, known.truth);
  options.solver = BundleSolver::ceres;
  const BundleSolution ceres = adjust(problem(), options, known.truth);
  EXPECT_EQ(own.summary.termination, BundleTermination::converged);
  EXPECT_EQ(ceres.summary.termination, BundleTermination::converged);
  EXPECT_NEAR(ceres.summary.initial_cost, own.summary.initial_cost,
              1e-9 * own.summary.initial_cost);
  EXPECT_NEAR(ceres.summary.final_cost, own.summary.final_cost, 1e-7 * own.summary.final_cost);
  EXPECT_LT(own.summary.final_cost, own.summary.initial_cost);
  for (const MarkerIndex m : known.observations.markers.indices()) {
    EXPECT_LT(ceres.estimate.world_from_marker[m]->minus(*own.estimate.world_from_marker[m]).norm(),
              1e-4);
  }
  const auto& rigs = ceres.estimate.calibration.rigs.front().cameras;
  const auto& own_rigs = own.estimate.calibration.rigs.front().cameras;
  for (std::size_t c = 0; c < rigs.size(); ++c) {
    EXPECT_LT(rigs[c].rig_from_cam.minus(own_rigs[c].rig_from_cam).norm(), 1e-4);
    EXPECT_NEAR(rigs[c].model.parameters().fu_px, own_rigs[c].model.parameters().fu_px, 0.05);
  }
  ASSERT_EQ(ceres.uncertainty.has_value(), own.uncertainty.has_value());
}

INSTANTIATE_TEST_SUITE_P(
    Problems, CeresAdjuster,
    testing::Values(Variant{"squared", {Loss::squared, 6.0}, {}},
                    Variant{"huber", {Loss::huber, 3.0}, {}},
                    Variant{"extrinsics", {Loss::huber, 6.0}, {.extrinsics = true}},
                    Variant{"rig", {Loss::huber, 6.0}, {.extrinsics = true, .intrinsics = true}},
                    Variant{
                        "surveyed", {Loss::huber, 6.0}, {.sizes = true, .edge_bias = true}, true}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace waymark
