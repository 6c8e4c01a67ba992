#include "mapbuilder/calibration/calibration_options.h"

#include "core/base/range.h"

namespace waymark {

Status check(const CalibrationOptions& options) {
  const RefinementLimits& limits = options.refinement_limits;
  return RangeCheck()
      .field("refinement_limits.position_m", limits.position_m, {1e-5, 1.0})
      .field("refinement_limits.rotation_rad", limits.rotation_rad, {1e-5, 0.1})
      .field("refinement_limits.focal", limits.focal, {1e-5, 0.1})
      .field("refinement_limits.size", limits.size, {1e-5, 0.1})
      .field("refinement_limits.most_unsure", limits.most_unsure, {2.0, 100.0})
      .status();
}

}  // namespace waymark
