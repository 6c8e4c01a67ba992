#pragma once

#include "mapbuilder/bundle/reduced_problem.h"

namespace waymark {

/// The optimum from the problem's start by Levenberg–Marquardt over the reduced system. Fills the
/// summary's termination, iterations and costs.
[[nodiscard]] BundleVariables minimize_reduced(ReducedProblem& problem,
                                               const BundleOptions& options,
                                               BundleSummary& summary);

}  // namespace waymark
