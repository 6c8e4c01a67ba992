#include <ceres/ceres.h>

#include <memory>
#include <random>

#include "core/estimate/corner_residual.h"
#include "mapbuilder/bundle/joint_adjustment.h"
#include "tests/mapbuilder/observations/room_table.h"

namespace waymark {
namespace {

/// The four corner residuals of one observation in sigmas, for Ceres to differentiate numerically;
/// parameters: world_from_marker, world_from_rig, each as a step from where it stood.
struct ObservationCost {
  const TableObservation* observation;
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

class CeresReference : public testing::TestWithParam<double> {};

TEST_P(CeresReference, TheAdjustmentFindsTheSameOptimum) {
  const double huber_sigmas = GetParam();
  test::RoomOptions options;
  options.noise_px = 0.5;
  const auto room = test::make_room(options);
  auto table = test::table_of(room);
  // A few observations far in the loss's linear part.
  for (std::size_t i = 0; i < table.observations.size(); i += 37) {
    table.observations[i].corners_px[1] += Eigen::Vector2d(6, -4);
  }
  const MapState start = test::true_state(room, table);
  MapState state = start;
  const auto summary = adjust_jointly(table, test::all_observations(table), {{0}, {}},
                                      {{Loss::huber, huber_sigmas}, 100, 1e-15, 1e-6}, state);
  EXPECT_TRUE(summary.converged);

  std::vector<Vector6d> marker_step(table.markers.size(), Vector6d::Zero());
  std::vector<Vector6d> rig_step(table.frame_sets.size(), Vector6d::Zero());
  ceres::Problem problem;
  for (const TableObservation& o : table.observations) {
    const auto m = static_cast<std::size_t>(o.marker);
    const auto f = static_cast<std::size_t>(o.frame_set);
    auto* cost = new ceres::NumericDiffCostFunction<ObservationCost, ceres::CENTRAL, 8, 6, 6>(
        new ObservationCost{&o, &camera_of(table, o), *start.world_from_marker[m],
                            start.rigs[f]->best.pose});
    problem.AddResidualBlock(cost, new ceres::HuberLoss(huber_sigmas), marker_step[m].data(),
                             rig_step[f].data());
  }
  problem.SetParameterBlockConstant(rig_step[0].data());
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_SCHUR;
  solver.function_tolerance = 1e-14;
  solver.max_num_iterations = 100;
  ceres::Solver::Summary reference;
  ceres::Solve(solver, &problem, &reference);
  EXPECT_NEAR(summary.initial_cost, reference.initial_cost, 1e-9 * reference.initial_cost);
  EXPECT_NEAR(summary.final_cost, reference.final_cost, 1e-6 * reference.final_cost);
  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    const Rigid3 expected = start.world_from_marker[m]->plus(marker_step[m]);
    EXPECT_LT(state.world_from_marker[m]->minus(expected).norm(), 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(Losses, CeresReference, testing::Values(3.0, 1e6),
                         [](const auto& info) { return info.param < 10 ? "huber" : "squared"; });

}  // namespace
}  // namespace waymark
