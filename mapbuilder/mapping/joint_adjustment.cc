#include "mapbuilder/mapping/joint_adjustment.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "core/estimate/corner_residual.h"

namespace waymark {
namespace {

/// Pose as Ceres stores it: translation (m), then quaternion x y z w.
using PoseBlock = std::array<double, 7>;

Rigid3 to_pose(const double* block) {
  return {Eigen::Quaterniond(block[6], block[3], block[4], block[5]),
          Eigen::Vector3d(block[0], block[1], block[2])};
}

PoseBlock to_block(const Rigid3& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

/// Rigid3's tangent as a Ceres manifold. Jacobians are given in the tangent directly: the cost
/// function writes them into the first six of the seven ambient columns, and this manifold's Plus
/// Jacobian picks those.
class RigidManifold : public ceres::Manifold {
 public:
  [[nodiscard]] int AmbientSize() const override { return 7; }
  [[nodiscard]] int TangentSize() const override { return 6; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Rigid3 moved = to_pose(x).plus(Eigen::Map<const Vector6d>(delta));
    const PoseBlock block = to_block(moved);
    std::copy(block.begin(), block.end(), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d> delta(y_minus_x);
    delta = to_pose(y).minus(to_pose(x));
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
};

/// The four corner residuals of one observation in sigmas; parameters: world_from_marker,
/// world_from_rig.
class ObservationCost : public ceres::SizedCostFunction<8, 7, 7> {
 public:
  ObservationCost(const MarkerObservation& observation, const RigCamera& camera)
      : observation_(observation),
        camera_(camera.model),
        cam_from_rig_(camera.rig_from_cam.inverse()) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const CornerChain chain(camera_, cam_from_rig_, to_pose(parameters[1]), to_pose(parameters[0]));
    const auto x_in_marker = marker_corners(observation_.size_m);
    for (std::size_t i = 0; i < 4; ++i) {
      CornerJacobians corner;
      const auto residual = corner_residual(chain, x_in_marker[i], observation_.corners_px[i],
                                            jacobians == nullptr ? nullptr : &corner);
      // Ceres takes the step back when a corner leaves the camera's domain.
      if (!residual) return false;
      const Eigen::Matrix2d& w = observation_.whitening[i];
      Eigen::Map<Eigen::Vector2d>(residuals + 2 * i) = w * *residual;
      if (jacobians == nullptr) continue;
      write_jacobian(jacobians[0], i, w * corner.d_marker);
      write_jacobian(jacobians[1], i, w * corner.d_rig);
    }
    return true;
  }

 private:
  static void write_jacobian(double* jacobian, std::size_t corner, const Jacobian26& j) {
    if (jacobian == nullptr) return;
    Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> rows(jacobian + 14 * corner);
    rows.leftCols<6>() = j;
    rows.col(6).setZero();
  }

  const MarkerObservation& observation_;
  const CameraModel& camera_;
  Rigid3 cam_from_rig_;
};

/// Observations that take part, in rising order.
std::vector<std::size_t> participating(const ObservationTable& table,
                                       std::span<const std::size_t> observations,
                                       const MapState& state) {
  std::vector<std::size_t> usable;
  std::map<int, int> per_set;
  for (const std::size_t index : observations) {
    const TableObservation& o = table.observations[index];
    if (state.accepted[index] == 0 || !state.posed(o)) continue;
    const CameraModel& camera = camera_of(table, o).model;
    const auto residuals = corner_residuals(o, camera, cam_from_marker(table, state, o));
    if (!residuals || std::any_of(residuals->begin(), residuals->end(), [&](const auto& r) {
          return r.norm() > gross_residual_px(camera);
        })) {
      continue;
    }
    usable.push_back(index);
    ++per_set[o.frame_set];
  }
  std::erase_if(
      usable, [&](std::size_t index) { return per_set[table.observations[index].frame_set] < 2; });
  return usable;
}

ceres::Solver::Options solver_options(const AdjustmentOptions& options, std::size_t markers) {
  ceres::Solver::Options solver;
  // Dense while the reduced marker system is small: no symbolic work, and nearly full anyway.
  solver.linear_solver_type = markers <= 120 ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.gradient_tolerance = 1e-14;
  solver.parameter_tolerance = 1e-12;
  solver.initial_trust_region_radius = 1.0 / options.initial_damping;
  solver.max_trust_region_radius = 1e20;
  solver.min_lm_diagonal = 1e-9;
  // One thread: Ceres adds up cost, gradient and Schur complement in the order in which threads
  // end.
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  return solver;
}

}  // namespace

AdjustmentSummary adjust_jointly(const ObservationTable& table,
                                 std::span<const std::size_t> observations, int anchor,
                                 const AdjustmentOptions& options, MapState& state) {
  AdjustmentSummary summary;
  const std::vector<std::size_t> used = participating(table, observations, state);
  summary.observations = used.size();
  if (used.empty()) return summary;

  // The canonical array: markers by index, then frame sets by index.
  std::map<int, std::size_t> marker_slot;
  std::map<int, std::size_t> rig_slot;
  for (const std::size_t index : used) {
    marker_slot.emplace(table.observations[index].marker, 0);
    rig_slot.emplace(table.observations[index].frame_set, 0);
  }
  std::vector<PoseBlock> blocks;
  blocks.reserve(marker_slot.size() + rig_slot.size());
  for (auto& [marker, slot] : marker_slot) {
    slot = blocks.size();
    blocks.push_back(to_block(*state.world_from_marker[static_cast<std::size_t>(marker)]));
  }
  for (auto& [frame_set, slot] : rig_slot) {
    slot = blocks.size();
    blocks.push_back(to_block(state.rigs[static_cast<std::size_t>(frame_set)]->best.pose));
  }

  RigidManifold manifold;
  std::unique_ptr<ceres::LossFunction> loss;
  if (options.loss.loss == Loss::huber) {
    loss = std::make_unique<ceres::HuberLoss>(options.loss.scale_sigmas);
  } else if (options.loss.loss == Loss::tukey) {
    loss = std::make_unique<ceres::TukeyLoss>(options.loss.scale_sigmas);
  }
  ceres::Problem::Options problem_options;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t slot = 0; slot < blocks.size(); ++slot) {
    problem.AddParameterBlock(blocks[slot].data(), 7, &manifold);
    // Rig poses are eliminated first; what is left is the reduced marker system.
    ordering->AddElementToGroup(blocks[slot].data(), slot < marker_slot.size() ? 1 : 0);
  }
  std::deque<ObservationCost> costs;  // never moved: Ceres keeps their addresses
  for (const std::size_t index : used) {
    const TableObservation& o = table.observations[index];
    costs.emplace_back(o, camera_of(table, o));
    problem.AddResidualBlock(&costs.back(), loss.get(), blocks[marker_slot.at(o.marker)].data(),
                             blocks[rig_slot.at(o.frame_set)].data());
  }
  if (const auto slot = rig_slot.find(anchor); slot != rig_slot.end()) {
    problem.SetParameterBlockConstant(blocks[slot->second].data());
  }

  ceres::Solver::Options solver = solver_options(options, marker_slot.size());
  solver.linear_solver_ordering = ordering;
  ceres::Solver::Summary result;
  ceres::Solve(solver, &problem, &result);
  summary.converged = result.termination_type == ceres::CONVERGENCE;
  summary.iterations = static_cast<int>(result.iterations.size());
  summary.initial_cost = result.initial_cost;
  summary.final_cost = result.final_cost;
  if (!result.IsSolutionUsable()) return summary;

  for (const auto& [marker, slot] : marker_slot) {
    state.world_from_marker[static_cast<std::size_t>(marker)] = to_pose(blocks[slot].data());
  }
  for (const auto& [frame_set, slot] : rig_slot) {
    state.rigs[static_cast<std::size_t>(frame_set)]->best.pose = to_pose(blocks[slot].data());
  }
  return summary;
}

}  // namespace waymark
