#pragma once

#include <string>
#include <vector>

#include "mapbuilder/growth/component_fit.h"
#include "mapbuilder/growth/joint_build.h"

namespace waymark {

/// Of the cost, the share that must go when something of the rig file is freed before it is said
/// not to fit: noise gives up a few per mille. (0.5–0.99)
inline constexpr double kExplainsTooLittle = 0.9;

/// What survey and refinement made of the calibration, and whether the rig file fits.
struct CalibrationResult {
  std::vector<std::string> refused;  ///< reasons; empty: the refinement stands
  /// Directions that the data can't tell, held where the rig file has them; the rest is refined.
  std::vector<std::string> held;
  CalibrationUncertainty uncertainty;  ///< of rigs_fitted
  std::vector<Rig> rigs_before;        ///< of the table
  std::vector<Rig> rigs_fitted;
  bool refined = false;  ///< the map is built with what was fitted; else it is evidence only
  /// Robust cost with freed extrinsics to that without, and with freed intrinsics on top of them.
  double extrinsics_cost_ratio = 1.0;
  double intrinsics_cost_ratio = 1.0;
  std::vector<ComponentFit> fits;  ///< per part of the build
};

/// Takes survey and refinement into the adjustment of all parts at once, so that there is one
/// calibration; parts that survey points fix in all six freedoms move into the facility's world and
/// are one from then on. Puts everything back when the data can't support the refinement: then the
/// build is the one without it. Where nothing was refined, a trial on copies shows whether the rig
/// file fits.
[[nodiscard]] CalibrationResult calibrate(JointBuild& build);

}  // namespace waymark
