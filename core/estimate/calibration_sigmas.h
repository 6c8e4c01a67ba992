#pragma once

#include <numbers>

namespace waymark {

/// How sure one camera's calibration is (1 sigma, per axis where there are several). Errors of this
/// kind are the same in every image. The defaults are what a careful calibration with Kalibr has.
struct CalibrationSigmas {
  double position_m = 1e-3;                             ///< of rig_from_cam
  double rotation_rad = 0.05 * std::numbers::pi / 180;  ///< of rig_from_cam
  double focal = 1e-3;                                  ///< share, fu and fv alike
  double principal_px = 0.5;
  double k1 = 5e-3;       ///< the first lens coefficient
  double edge_px = 0.02;  ///< how far edges are seen outward of where they are
  double stamp_s = 1e-3;  ///< of the offset of its stamps
  double readout_s = 0;   ///< of the time from first to last row

  /// A calibration without any error, as a simulation has it.
  [[nodiscard]] static constexpr CalibrationSigmas exact() { return {0, 0, 0, 0, 0, 0, 0, 0}; }
};

}  // namespace waymark
