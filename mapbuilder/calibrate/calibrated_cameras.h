#pragma once

#include <array>
#include <vector>

#include "core/camera/rig.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// Captures of one rig with one rig file for all: that of the capture with the most cameras. A
/// capture may lack the last of them. Errors: bad_data where two captures have images of different
/// sizes of one camera, or give it different numbers of their own.
[[nodiscard]] Expected<std::vector<DetectedCapture>> with_common_rig(
    std::vector<DetectedCapture> captures);

/// The captures as one camera alone has them: rigs of this camera, its images. Captures without
/// one are left out.
[[nodiscard]] std::vector<DetectedCapture> captures_of_camera(
    const std::vector<DetectedCapture>& captures, std::size_t camera);

/// The captures with other numbers of their rig.
[[nodiscard]] std::vector<DetectedCapture> with_rig(std::vector<DetectedCapture> captures,
                                                    const Rig& rig);

/// The captures' images in two halves: each capture's instants in eight blocks by time, taken in
/// turn, so that what changes in the course of a round is in both and neighbours are in one.
[[nodiscard]] std::array<std::vector<DetectedCapture>, 2> halves_of(
    const std::vector<DetectedCapture>& captures);

}  // namespace waymark
