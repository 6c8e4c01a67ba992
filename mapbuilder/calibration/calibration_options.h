#pragma once

#include "mapbuilder/bundle/bundle_problem.h"
#include "mapbuilder/import/survey.h"

namespace waymark {

/// A refinement less sure than this is refused (one standard deviation).
struct RefinementLimits {
  double position_m = 0.002;       ///< (1e-5–1)
  double rotation_rad = 0.001745;  ///< (1e-5–0.1) 0.1°; of the lens: how far bearings may shift
  double focal = 0.003;            ///< (1e-5–0.1) as a share of the focal length
  double size = 0.003;             ///< (1e-5–0.1) as a share of the stated size
  /// (2–100) Directions may exceed the limits by this factor and stay as stated; beyond, where the
  /// equations are no longer linear within a sigma, the refinement is refused as a whole.
  double most_unsure = 10.0;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// What may correct rig, lens and sizes.
struct CalibrationOptions {
  Survey survey;               ///< measured on site; may be empty
  VariableCalibration refine;  ///< extrinsics, intrinsics, sizes: what the user asks for
  RefinementLimits refinement_limits;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

}  // namespace waymark
