#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/camera_controls.h"
#include "drivers/v4l2/control_watch.h"
#include "drivers/v4l2/video_node.h"

namespace waymark {

/// How it was found to take them.
struct AppliedControls {
  Stamp exposure{0};  ///< length; 0: not known, because automatic or not told
  std::optional<double> gain;
  std::vector<HeldControl> held;   ///< in the order in which they are to be set
  std::vector<std::string> notes;  ///< what could not be switched off, one line each
};

/// Sets the controls and reads them back. Automatic focus is always switched off, for it changes
/// the calibration. Errors: config for a value that the device has no control for or does not take;
/// those of node_error.
[[nodiscard]] Expected<AppliedControls> apply_controls(VideoNode& node,
                                                       const CameraControls& controls);

/// How a camera is found to take its images that another library was told to set so. Errors: io
/// when its exposure is not the wanted one, for it may have failed for any reason; those of
/// node_error.
[[nodiscard]] Expected<AppliedControls> read_controls(VideoNode& node,
                                                      const CameraControls& wanted);

}  // namespace waymark
