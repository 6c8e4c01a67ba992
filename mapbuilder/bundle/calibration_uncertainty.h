#pragma once

#include "mapbuilder/bundle/reduced_problem.h"

namespace waymark {

/// How sure the problem is of its calibration at these values of its variables.
[[nodiscard]] CalibrationUncertainty uncertainty_of(ReducedProblem& problem,
                                                    const BundleVariables& at);

}  // namespace waymark
