#pragma once

#include <optional>

#include "core/base/range.h"

namespace waymark {

/// How a camera shall take its images; what is absent stays as the device has it.
struct CameraControls {
  std::optional<double> exposure_us = std::nullopt;  ///< µs; automatic exposure is switched off
  /// In the driver's unit (v4l2: the device's own, libcamera: a factor); automatic gain is off.
  std::optional<double> gain = std::nullopt;
  std::optional<double> white_balance_k = std::nullopt;  ///< K; not automatic then
  std::optional<double> focus = std::nullopt;            ///< in the driver's unit
  std::optional<int> power_line_hz = std::nullopt;       ///< 0 (off), 50 or 60

  static constexpr Range kExposure_us{1, 1e6};
  static constexpr Range kGain{0, 1e6};
  static constexpr Range kWhiteBalance_k{1000, 20'000};
  static constexpr Range kFocus{0, 1e6};
  [[nodiscard]] static bool is_power_line_hz(double hz) { return hz == 0 || hz == 50 || hz == 60; }
  /// usage, naming the first that is there and outside its range.
  [[nodiscard]] Status check() const;
};

}  // namespace waymark
