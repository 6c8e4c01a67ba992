#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/capture/capture_folder.h"
#include "core/detect/edge_bias.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// Whether the rig file tells a camera's edges: their bias, or that they are surer than images tell
/// (kSurestEdges_px), as a simulator does.
[[nodiscard]] bool states_edges(const RigCamera& camera);

/// Measures for each camera of the capture how far its edges lie inside the black, on up to 120 of
/// its markers, whose images are read again, and moves the corners of all its detections outward:
/// markers that were fitted by their own, the others by the mean. A camera whose markers do not
/// tell (edge_bias), or whose rig file does (states_edges), stays as it is: its entry is nullopt.
/// Sets the capture's edges. `detected` must come from the capture's images. Never depends on the
/// number of threads.
[[nodiscard]] std::vector<std::optional<EdgeBias>> correct_edges(const CaptureFolder& capture,
                                                                 DetectedCapture& detected,
                                                                 int threads, Progress& progress);

/// "cam0: edges 0.268 ± 0.009 px inside the black (68 markers, response …)", or that nothing tells.
[[nodiscard]] std::string edges_text(const std::string& camera,
                                     const std::optional<EdgeBias>& bias);

}  // namespace waymark
