#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/v4l2/video_node.h"

namespace waymark {

/// How a camera shall take its images; what is absent stays as the device has it.
struct CameraControls {
  std::optional<double> exposure_us = std::nullopt;  ///< µs; automatic exposure is switched off
  std::optional<double> gain =
      std::nullopt;  ///< in the device's unit; automatic gain is switched off
  std::optional<double> white_balance_k =
      std::nullopt;                                 ///< K; automatic white balance is switched off
  std::optional<double> focus = std::nullopt;       ///< in the device's unit
  std::optional<int> power_line_hz = std::nullopt;  ///< 0 (off), 50 or 60
};

/// How it was found to take them.
struct AppliedControls {
  Stamp exposure{0};  ///< length; 0: not known, because automatic or not told
  std::optional<double> gain;
  std::vector<std::string> notes;  ///< what could not be switched off, one line each
};

/// Sets the controls and reads them back. Automatic focus is always switched off, for it changes
/// the calibration. Errors: config for a value that the device has no control for or does not take;
/// those of node_error.
[[nodiscard]] Expected<AppliedControls> apply_controls(VideoNode& node,
                                                       const CameraControls& controls);

}  // namespace waymark
