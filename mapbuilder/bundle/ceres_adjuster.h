#pragma once

#include "mapbuilder/bundle/reduced_problem.h"

namespace waymark {

/// The optimum from the problem's start by Ceres Solver: the same residuals and variables, another
/// minimizer. Slower than minimize_reduced, and not the same bytes over threads. Fills the
/// summary's termination, iterations and costs; where Ceres fails, the start is what it gives.
[[nodiscard]] BundleVariables minimize_with_ceres(const ReducedProblem& problem,
                                                  const ObservationLoss& loss,
                                                  const BundleOptions& options,
                                                  BundleSummary& summary);

}  // namespace waymark
