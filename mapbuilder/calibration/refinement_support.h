#pragma once

#include <string>
#include <vector>

#include "mapbuilder/calibration/calibration_options.h"

namespace waymark {

/// A direction of the rig file's numbers that the data knows less surely than the limits ask.
struct UnsureDirection {
  ConstantDirection direction;
  bool of_extrinsics = false;  ///< for the larger part; else of intrinsics
  double in_limits = 0;        ///< its sigma over the limit
  std::string text;  ///< "cam2's position …: known to ± 4.2 mm only, 2 mm is asked for"
};

/// All of them, from the joint covariance of `sure` in units of the limits: its eigenvectors of
/// more than 1. Principal point and lens count by how far they shift bearings, RMS over the image.
/// None where `sure` says that nothing is determined.
[[nodiscard]] std::vector<UnsureDirection> unsure_directions(
    const CalibrationUncertainty& sure, const IndexedVector<CameraIndex, RigCamera>& stated_cameras,
    const RefinementLimits& limits);

/// Why what the user asks for can't be supported, a line each: a rig of one camera has no
/// extrinsics; nothing is determined; a direction far beyond its limit, or as many directions
/// unsure as sure (then those that look sure rest on what stayed as stated); sizes less sure than
/// the limit. Empty: it can, but for `unsure`.
[[nodiscard]] std::vector<std::string> reasons_against(const VariableCalibration& asked,
                                                       const CalibrationUncertainty& sure,
                                                       const std::vector<UnsureDirection>& unsure,
                                                       const IndexedVector<RigIndex, Rig>& rigs,
                                                       const RefinementLimits& limits);

}  // namespace waymark
