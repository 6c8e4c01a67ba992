#include "mapbuilder/bundle/bundle_adjustment.h"

#include "core/base/check.h"
#include "mapbuilder/bundle/calibration_uncertainty.h"
#include "mapbuilder/bundle/ceres_adjuster.h"
#include "mapbuilder/bundle/gauge.h"
#include "mapbuilder/bundle/schur_adjuster.h"

namespace waymark {

BundleSolution adjust(const BundleProblem& problem, const BundleOptions& options,
                      Estimate estimate) {
  WAYMARK_CHECK(options.check() && problem.scope.check() && problem.loss.check());
  BundleSolution solution;
  const std::vector<ObservationIndex> counting = counting_observations(problem, estimate);
  solution.summary.observations = counting.size();
  if (counting.empty()) {
    solution.estimate = std::move(estimate);
    return solution;
  }
  const ConstantPoses constant = fix_gauge(problem, counting, estimate);
  ReducedProblem reduced(problem, counting, constant, estimate, options.threads);
  const BundleVariables optimum =
      options.solver == BundleSolver::ceres
          ? minimize_with_ceres(reduced, problem.loss, options, solution.summary)
          : minimize_reduced(reduced, options, solution.summary);
  if (problem.scope.variable.any()) solution.uncertainty = uncertainty_of(reduced, optimum);
  solution.estimate = reduced.estimate_at(optimum, std::move(estimate));
  return solution;
}

}  // namespace waymark
