#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/calibration/calibration_options.h"
#include "mapbuilder/growth/incremental_mapper.h"

namespace waymark {

/// Of the cost, the share that must go when something of the rig file is made variable before it is
/// said not to fit: noise gives up a few per mille. (0.5–0.99)
inline constexpr double kExplainsTooLittle = 0.9;

/// What survey and refinement made of the calibration, and whether the rig file fits.
struct CalibrationResult {
  std::vector<std::string> refused;  ///< reasons; empty: the refinement stands
  /// Directions that the data can't tell stay where the rig file has them; the rest is refined.
  std::vector<std::string> left_as_stated;
  CalibrationUncertainty uncertainty;  ///< of rigs_fitted
  IndexedVector<RigIndex, Rig> rigs_before;
  IndexedVector<RigIndex, Rig> rigs_fitted;
  bool refined = false;  ///< the map is built with what was fitted; else it is evidence only
  /// Robust cost with variable extrinsics to that without, and with variable intrinsics on top.
  double extrinsics_cost_ratio = 1.0;
  double intrinsics_cost_ratio = 1.0;
  /// Where the rig file does not fit: the estimate with a rig that was variable for a few steps.
  /// The map does not use it; single detections are judged by it.
  std::optional<Estimate> examined;
};

/// An estimate of all components as one system, with survey and refinement taken in.
struct CalibratedEstimate {
  Estimate estimate;
  AdjustedSystem system;
  CalibrationResult calibration;
};

/// Takes survey and refinement into the adjustment of all components at once, so that there is one
/// calibration; components that survey points fix in all six freedoms move into the facility's
/// world and are one from then on. Where the data can't support the refinement the estimate is the
/// one without it. Where nothing was refined, a trial on a copy shows whether the rig file fits.
/// The options must outlive what is returned.
[[nodiscard]] CalibratedEstimate calibrate(const IncrementalMapper& mapper,
                                           const CalibrationOptions& options, Estimate estimate,
                                           Progress& progress);

}  // namespace waymark
