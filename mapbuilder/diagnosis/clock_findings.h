#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/capture/frame_set.h"
#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// Cameras whose stamps keep their images out of the others' frame sets, told by the stamps alone:
/// those of another epoch, those a constant time apart, those that drift away (cause clock). A
/// camera whose stamps keep no fixed rhythm against the others' is not accused: it runs free.
/// `images` of one capture, in any order; `cameras` are names by number.
[[nodiscard]] std::vector<Finding> clock_findings(std::span<const StampedImage> images,
                                                  const std::vector<std::string>& cameras,
                                                  Stamp tolerance);

/// The same of several captures, each on its own.
[[nodiscard]] std::vector<Finding> clock_findings(const std::vector<DetectedCapture>& captures);

}  // namespace waymark
