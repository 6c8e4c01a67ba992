#pragma once

#include <optional>

namespace waymark {

/// How a camera shall take its images; what is absent stays as the device has it.
struct CameraControls {
  std::optional<double> exposure_us = std::nullopt;  ///< µs; automatic exposure is switched off
  /// In the driver's unit (v4l2: the device's own, libcamera: a factor); automatic gain is off.
  std::optional<double> gain = std::nullopt;
  std::optional<double> white_balance_k = std::nullopt;  ///< K; not automatic then
  std::optional<double> focus = std::nullopt;            ///< in the driver's unit
  std::optional<int> power_line_hz = std::nullopt;       ///< 0 (off), 50 or 60
};

}  // namespace waymark
