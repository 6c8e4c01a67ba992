#include "mapbuilder/bundle/joint_adjustment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "core/base/parallel.h"
#include "core/estimate/corner_residual.h"
#include "core/estimate/ippe.h"
#include "mapbuilder/bundle/block_cholesky.h"
#include "mapbuilder/bundle/direction_hold.h"
#include "mapbuilder/bundle/edge_bias.h"
#include "mapbuilder/bundle/free_pieces.h"
#include "mapbuilder/bundle/survey_factors.h"

namespace waymark {
namespace {

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

/// Levenberg–Marquardt's damping by the gain of each step (Nielsen, 1999).
class Damping {
 public:
  explicit Damping(double start) : value_(start) {}
  [[nodiscard]] double value() const { return value_; }
  void step_taken(double gain) {
    const double turn = 2.0 * gain - 1.0;
    value_ = std::max(kSmallest, value_ * std::max(1.0 / 3.0, 1.0 - turn * turn * turn));
    raise_ = 2.0;
  }
  void step_refused() {
    value_ *= raise_;
    raise_ *= 2.0;
  }
  [[nodiscard]] bool hopeless() const { return value_ > 1e16; }

 private:
  static constexpr double kSmallest = 1e-16;
  double value_;
  double raise_ = 2.0;
};

void damp(ReducedSystem& system, double damping) {
  for (int block = 0; block < system.information.pattern.columns(); ++block) {
    const int diagonal = system.information.pattern.first[static_cast<std::size_t>(block)];
    system.information.blocks[static_cast<std::size_t>(diagonal)].diagonal() +=
        damping * system.kept_diagonal.segment<6>(6L * block);
  }
}

/// Minimizes the problem from its start.
JointUnknowns minimize(JointProblem& problem, const AdjustmentOptions& options,
                       AdjustmentSummary& summary) {
  JointUnknowns here = problem.start();
  Damping damping(options.initial_damping);
  ReducedSystem system = problem.reduce(here, damping.value());
  summary.initial_cost = summary.final_cost = system.cost;
  BlockCholesky cholesky(problem.pattern());
  while (summary.iterations < options.max_iterations && !damping.hopeless()) {
    ++summary.iterations;
    damp(system, damping.value());
    double gain = -1;
    if (cholesky.factorize(system.information)) {
      const Eigen::VectorXd step = -cholesky.solve(system.gradient);
      double promised = 0;
      JointUnknowns there = problem.moved(here, step, promised);
      promised += 0.5 * step.dot(damping.value() * system.kept_diagonal.cwiseProduct(step) -
                                 system.gradient);
      const double cost = problem.cost(there);
      const double decrease = summary.final_cost - cost;
      if (std::isfinite(cost) && decrease >= 0 && promised > 0) {
        gain = decrease / promised;
        here = std::move(there);
        summary.final_cost = cost;
      }
      // Nothing left to win, be the step taken or lost in rounding.
      constexpr double kNegligible = 1e-9;  // sigmas²
      if (std::max(decrease, promised) <=
          options.function_tolerance * summary.final_cost + kNegligible) {
        summary.converged = true;
        break;
      }
    }
    if (gain >= 0) {
      damping.step_taken(gain);
    } else {
      damping.step_refused();
    }
    system = problem.reduce(here, damping.value());
  }
  return here;
}

/// See CalibrationUncertainty::joint; zero rows where nothing is free.
Eigen::MatrixXd joint_covariance(const KeptLayout& layout, const BlockCholesky& cholesky) {
  std::vector<int> kept_row;  // −1: not free
  for (const int block : layout.extrinsics) {
    for (int r = 0; r < 6; ++r) kept_row.push_back(block < 0 ? -1 : 6 * block + r);
  }
  for (std::size_t c = 0; c < layout.focal.size(); ++c) {
    for (const int block : {layout.focal[c], layout.lens[c]}) {
      for (int r = 0; r < 4; ++r) kept_row.push_back(block < 0 ? -1 : 6 * block + r);
    }
  }
  const auto count = static_cast<Eigen::Index>(kept_row.size());
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(6L * layout.blocks, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const int row = kept_row[static_cast<std::size_t>(i)];
    if (row >= 0) unit(row, i) = 1.0;
  }
  return unit.transpose() * cholesky.solve(unit);
}

CalibrationUncertainty uncertainty_of(JointProblem& problem, const JointUnknowns& at) {
  const KeptLayout& layout = problem.layout();
  BlockCholesky cholesky(problem.pattern());
  const bool determined = cholesky.factorize(problem.reduce(at, 0.0).information);
  const std::vector<Matrix6d> covariance =
      determined ? cholesky.inverse_diagonal() : std::vector<Matrix6d>{};
  const auto sigma = [&](int block, int first, int count) {
    if (block < 0) return 0.0;
    if (!determined) return std::numeric_limits<double>::infinity();
    const auto diagonal = covariance[static_cast<std::size_t>(block)].diagonal();
    return std::sqrt(diagonal.segment(first, count).maxCoeff());
  };
  CalibrationUncertainty uncertainty;
  for (std::size_t c = 0; c < at.cameras.size(); ++c) {
    const CameraParameters& camera = at.cameras[c].model.parameters();
    uncertainty.cameras.push_back(
        {sigma(layout.extrinsics[c], 0, 3), sigma(layout.extrinsics[c], 3, 3),
         sigma(layout.focal[c], 0, 2) / camera.fu_px, sigma(layout.edge_bias[c], 0, 1)});
  }
  for (const int block : layout.size) uncertainty.size_factor.push_back(sigma(block, 0, 1));
  if (determined) uncertainty.joint = joint_covariance(layout, cholesky);
  return uncertainty;
}

/// Writes what was calibrated into the table.
void calibrate(const JointProblem& problem, const JointUnknowns& optimum, int threads,
               ObservationTable& table) {
  std::size_t camera = 0;
  std::vector<std::size_t> first_camera;
  for (Rig& rig : table.rigs) {
    first_camera.push_back(camera);
    for (RigCamera& own : rig.cameras) own = optimum.cameras[camera++];
  }
  for (std::size_t c = 0; c < camera; ++c) table.edge_bias_px[c] += optimum.edge_bias_px[c];
  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    table.sizes_m[m] *=
        optimum.size_factor[static_cast<std::size_t>(problem.size_class_of(static_cast<int>(m)))];
  }
  parallel_for(table.observations.size(), threads, [&](std::size_t index) {
    TableObservation& o = table.observations[index];
    const TableFrameSet& set = table.frame_sets[static_cast<std::size_t>(o.frame_set)];
    const double bias_px = optimum.edge_bias_px[first_camera[static_cast<std::size_t>(set.rig)] +
                                                static_cast<std::size_t>(o.camera)];
    if (bias_px != 0.0) {
      const auto outward = outward_of(o.corners_px);
      for (std::size_t i = 0; i < 4; ++i) o.corners_px[i] -= bias_px * outward[i];
    }
    o.size_m = table.sizes_m[static_cast<std::size_t>(o.marker)];
    o.ippe = solve_ippe(camera_of(table, o).model, o.corners_px, o.size_m);
  });
}

}  // namespace

std::vector<std::unique_ptr<KeptFactor>> factors_of(const AdjustmentScope& scope,
                                                    const ObservationTable& table,
                                                    const JointProblem& problem) {
  std::vector<std::unique_ptr<KeptFactor>> factors;
  if (scope.survey != nullptr) {
    factors = survey_factors(*scope.survey, table, problem, scope.world_of_marker);
  }
  if (scope.free.sizes) {
    std::map<int, double> already;
    for (std::size_t m = 0; m < table.markers.size(); ++m) {
      already.emplace(problem.size_class_of(static_cast<int>(m)),
                      table.sizes_m[m] / table.stated_sizes_m[m]);
    }
    for (const auto& [size_class, factor] : already) {
      if (problem.layout().size[static_cast<std::size_t>(size_class)] < 0) continue;
      factors.push_back(
          size_prior(problem, static_cast<std::size_t>(size_class), factor, scope.size_sigma));
    }
  }
  for (const HeldDirection& direction : scope.held_directions) {
    factors.push_back(
        direction_hold(problem, scope.stated_cameras, direction.extrinsics, direction.intrinsics));
  }
  if (scope.free.edge_bias) {
    for (std::size_t c = 0; c < problem.start().cameras.size(); ++c) {
      if (problem.layout().edge_bias[c] < 0) continue;
      factors.push_back(
          edge_bias_prior(problem, c, table.edge_bias_px[c], scope.edge_bias_sigma_px));
    }
  }
  return factors;
}

AdjustmentSummary adjust_jointly(ObservationTable& table, std::span<const std::size_t> observations,
                                 const HeldPoses& held, const AdjustmentOptions& options,
                                 MapState& state) {
  AdjustmentSummary summary;
  const std::vector<std::size_t> used = participating(table, observations, state);
  summary.observations = used.size();
  if (used.empty()) return summary;
  const AdjustmentScope& scope = options.scope;
  const HeldPoses all_held = hold_free_pieces(table, used, scope, state, held);
  JointProblem problem(table, used, state, all_held, scope.free, options.loss, options.threads);
  const auto factors = factors_of(scope, table, problem);
  for (const auto& factor : factors) problem.add(*factor);
  const JointUnknowns optimum = minimize(problem, options, summary);
  if (scope.free.any()) {
    summary.uncertainty = uncertainty_of(problem, optimum);
    calibrate(problem, optimum, options.threads, table);
  }
  for (std::size_t m = 0; m < problem.markers().size(); ++m) {
    state.world_from_marker[static_cast<std::size_t>(problem.markers()[m])] =
        optimum.world_from_marker[m];
  }
  for (std::size_t f = 0; f < problem.frame_sets().size(); ++f) {
    state.rigs[static_cast<std::size_t>(problem.frame_sets()[f])]->best.pose =
        optimum.world_from_rig[f];
  }
  return summary;
}

}  // namespace waymark
