#pragma once

#include "mapbuilder/calibration/calibration.h"

namespace waymark {

/// Whether the rig file fits the images: a few steps with all of it variable. What they find is
/// evidence, the estimate stays as it is. Fills the result's cost ratios, rigs_fitted, uncertainty
/// and, where the file does not fit, the examined estimate.
void examine_rig(const IncrementalMapper& mapper, const AdjustedSystem& system,
                 const Estimate& estimate, CalibrationResult& result);

}  // namespace waymark
