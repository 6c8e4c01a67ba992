#include "mapbuilder/calibration/calibration_options.h"

#include "core/base/range.h"

namespace waymark {

Status RefinementLimits::check() const {
  return RangeCheck()
      .field("position_m", position_m, {1e-5, 1.0})
      .field("rotation_rad", rotation_rad, {1e-5, 0.1})
      .field("focal", focal, {1e-5, 0.1})
      .field("size", size, {1e-5, 0.1})
      .field("most_unsure", most_unsure, {2.0, 100.0})
      .status();
}

Status CalibrationOptions::check() const {
  return RangeCheck().part("refinement_limits", refinement_limits.check()).status();
}

}  // namespace waymark
