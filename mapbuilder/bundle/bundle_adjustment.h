#pragma once

#include <optional>

#include "mapbuilder/bundle/bundle_problem.h"

namespace waymark {

/// What an adjustment gives.
struct BundleSolution {
  Estimate estimate;
  BundleSummary summary;
  std::optional<CalibrationUncertainty> uncertainty;  ///< where calibration was variable
};

/// Solves the problem from an estimate, the one that its observations are prepared by. Constant
/// poses stay, and those of connected components that nothing else fixes (fix_gauge). Calibration
/// stays unless the scope makes it variable.
[[nodiscard]] BundleSolution adjust(const BundleProblem& problem, const BundleOptions& options,
                                    Estimate estimate);

}  // namespace waymark
