#pragma once

#include <cstdint>

#include "core/camera/camera_sigmas.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark::bench {

/// A capture whose rig, sizes and corners are exact, as somebody has it whose calibration is off:
/// of every number that Kalibr's default sigmas are of, an error is drawn from them and taken out
/// (stated = true less error), sizes are stated so, and corners move outward by the edges' error.
/// Sigmas are left unstated: the defaults. Not the mapper's own linear model: poses compose, focal
/// lengths and sizes are divided.
[[nodiscard]] DetectedCapture with_drawn_calibration(DetectedCapture exact, std::uint64_t seed);

}  // namespace waymark::bench
