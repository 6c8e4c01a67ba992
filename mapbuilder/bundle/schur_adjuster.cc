#include "mapbuilder/bundle/schur_adjuster.h"

#include <algorithm>
#include <cmath>

#include "mapbuilder/bundle/block_cholesky.h"

namespace waymark {
namespace {

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
        damping * system.diagonal.segment<6>(6L * block);
  }
}

}  // namespace

BundleVariables minimize_reduced(ReducedProblem& problem, const BundleOptions& options,
                                 BundleSummary& summary) {
  summary.termination = BundleTermination::no_convergence;
  BundleVariables here = problem.start();
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
      BundleVariables there = problem.moved(here, step, promised);
      promised +=
          0.5 * step.dot(damping.value() * system.diagonal.cwiseProduct(step) - system.gradient);
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
        summary.termination = BundleTermination::converged;
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

}  // namespace waymark
