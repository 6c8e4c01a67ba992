#pragma once

#include "mapbuilder/bundle/joint_problem.h"
#include "mapbuilder/bundle/noise_model.h"
#include "mapbuilder/bundle/outlier_gate.h"
#include "mapbuilder/growth/growth.h"
#include "mapbuilder/import/survey.h"

namespace waymark {

/// A refinement less sure than this is refused (one standard deviation).
struct RefinementLimits {
  double position_m = 0.002;       ///< (1e-5–1)
  double rotation_rad = 0.001745;  ///< (1e-5–0.1) 0.1°; of the lens: how far bearings may shift
  double focal = 0.003;            ///< (1e-5–0.1) as a share of the focal length
  double size = 0.003;             ///< (1e-5–0.1) as a share of the stated size
  /// (2–100) Directions may exceed the limits by this factor and be held; beyond, where the
  /// equations are no longer linear within a sigma, the refinement is refused as a whole.
  double most_held = 10.0;
};

/// Options of a build. Defaults are what `mapbuilder build` uses.
struct BuildOptions {
  NoiseModel noise;      ///< its model_sigma_px is the start; it is estimated from the residuals
  ObservationLoss loss;  ///< of Algorithms 1 and 2
  GateOptions gate;
  GrowthOptions growth;
  Survey survey;           ///< measured on site; may be empty
  FreeCalibration refine;  ///< extrinsics, intrinsics, sizes: what the user asks for
  RefinementLimits refinement_limits;
  int max_passes = 8;  ///< (1–50) of adjust, reconsider, gate
  int threads = 0;     ///< 0 = all processors; never changes the result
};

}  // namespace waymark
