#pragma once

#include <vector>

#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/diagnosis/image_look.h"

namespace waymark {

/// What is wrong with a capture's images and prints, and with what markers.toml states of them:
/// another family, unlisted ids, mirrored, inverted or cut prints, darkness, cameras that
/// contribute nothing. `looks` are one per camera of the capture's rig.
[[nodiscard]] std::vector<Finding> input_findings(const DetectedCapture& capture,
                                                  const std::vector<CameraLook>& looks);

}  // namespace waymark
