#include "mapbuilder/mapping/joint_adjustment.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "core/estimate/corner_residual.h"
#include "mapbuilder/mapping/block_cholesky.h"

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
        damping * system.kept_diagonal.segment<6>(6 * block);
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

}  // namespace

AdjustmentSummary adjust_jointly(const ObservationTable& table,
                                 std::span<const std::size_t> observations, const HeldPoses& held,
                                 const AdjustmentOptions& options, MapState& state) {
  AdjustmentSummary summary;
  const std::vector<std::size_t> used = participating(table, observations, state);
  summary.observations = used.size();
  if (used.empty()) return summary;
  JointProblem problem(table, used, state, held, {}, options.loss, options.threads);
  const JointUnknowns optimum = minimize(problem, options, summary);
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
