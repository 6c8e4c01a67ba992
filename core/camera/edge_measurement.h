#pragma once

#include <optional>

#include "core/camera/sensor_response.h"

namespace waymark {

/// How far a camera sees edges inside the black, as its images tell.
struct EdgeMeasurement {
  double bias_px = 0;                      ///< positive: the black is larger than it looks
  double sigma_px = 0;                     ///< one standard deviation, > 0
  std::optional<SensorResponse> response;  ///< nullopt: not told
};

}  // namespace waymark
