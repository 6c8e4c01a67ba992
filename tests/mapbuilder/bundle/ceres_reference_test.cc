#include <ceres/ceres.h>

#include <memory>
#include <random>

#include "core/estimate/corner_residual.h"
#include "mapbuilder/bundle/bundle_adjustment.h"
#include "tests/mapbuilder/bundle/bundle_of_room.h"

namespace waymark {
namespace {

/// The four corner residuals of one observation in sigmas, for Ceres to differentiate numerically;
/// parameters: world_from_marker, world_from_rig, each as a step from where it stood.
struct ObservationCost {
  const MarkerObservation* observation;
  const RigCamera* camera;
  Rigid3 marker;
  Rigid3 rig;

  bool operator()(const double* marker_step, const double* rig_step, double* residuals) const {
    const CornerChain chain(camera->model, camera->rig_from_cam.inverse(),
                            rig.plus(Eigen::Map<const Vector6d>(rig_step)),
                            marker.plus(Eigen::Map<const Vector6d>(marker_step)));
    const auto x_in_marker = marker_corners(observation->size_m);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto residual =
          corner_residual(chain, x_in_marker[i], observation->corners_px[i], nullptr);
      if (!residual) return false;
      Eigen::Map<Eigen::Vector2d>(residuals + 2 * i) = observation->whitening[i] * *residual;
    }
    return true;
  }
};

class CeresReference : public testing::TestWithParam<Loss> {};

TEST_P(CeresReference, TheAdjustmentFindsTheSameOptimum) {
  constexpr double kHuberSigmas = 3.0;
  const auto reference_loss = []() -> ceres::LossFunction* {
    return GetParam() == Loss::huber ? new ceres::HuberLoss(kHuberSigmas) : nullptr;
  };
  test::RoomOptions options;
  options.noise_px = 0.5;
  const auto room = test::make_room(options);
  // A few observations far in the loss's linear part.
  const test::PreparedRoom known(room, [](Observations& observations) {
    for (std::size_t i = 0; i < observations.usable; i += 37) {
      observations.all[ObservationIndex(i)].corners_px[1] += Eigen::Vector2d(6, -4);
    }
  });
  BundleProblem bundle = test::bundle_of(known);
  bundle.loss = {GetParam(), kHuberSigmas};
  const BundleSolution solution =
      adjust(bundle, {.max_iterations = 100, .function_tolerance = 1e-15}, known.truth);
  const BundleSummary& summary = solution.summary;
  EXPECT_EQ(summary.termination, BundleTermination::converged);

  IndexedVector<MarkerIndex, Vector6d> marker_step(known.observations.markers.size(),
                                                   Vector6d::Zero());
  IndexedVector<FrameSetIndex, Vector6d> rig_step(known.observations.frame_sets.size(),
                                                  Vector6d::Zero());
  ceres::Problem problem;
  for (const ObservationIndex index : known.selection.used()) {
    const Observation& o = known.observations[index];
    auto* cost = new ceres::NumericDiffCostFunction<ObservationCost, ceres::CENTRAL, 8, 6, 6>(
        new ObservationCost{&known.prepared[index],
                            &known.truth.calibration.camera(known.observations, o),
                            *known.truth.world_from_marker[o.marker],
                            known.truth.world_from_rig[o.frame_set]->best.pose});
    problem.AddResidualBlock(cost, reference_loss(), marker_step[o.marker].data(),
                             rig_step[o.frame_set].data());
  }
  problem.SetParameterBlockConstant(rig_step.front().data());
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_SCHUR;
  solver.function_tolerance = 1e-14;
  solver.max_num_iterations = 100;
  ceres::Solver::Summary reference;
  ceres::Solve(solver, &problem, &reference);
  EXPECT_NEAR(summary.initial_cost, reference.initial_cost, 1e-9 * reference.initial_cost);
  EXPECT_NEAR(summary.final_cost, reference.final_cost, 1e-6 * reference.final_cost);
  for (const MarkerIndex m : marker_step.indices()) {
    const Rigid3 expected = known.truth.world_from_marker[m]->plus(marker_step[m]);
    EXPECT_LT(solution.estimate.world_from_marker[m]->minus(expected).norm(), 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(Losses, CeresReference, testing::Values(Loss::huber, Loss::squared),
                         [](const auto& info) {
                           return info.param == Loss::huber ? "huber" : "squared";
                         });

}  // namespace
}  // namespace waymark
