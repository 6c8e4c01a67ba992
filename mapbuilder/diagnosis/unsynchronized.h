#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/diagnosis/rig_agreement.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// A camera whose images are taken at another moment than the others' in every frame set.
struct UnsynchronizedCamera {
  std::size_t camera = 0;
  double scatter_s = 0;       ///< of its moments against the others', one robust standard deviation
  double speed_mps = 0;       ///< median, of the rig
  double turn_rad_per_s = 0;  ///< median
  double misfit_before = 0;   ///< median, sigmas², as if all were taken together
  double misfit_after = 0;    ///< with each image at its own moment
  std::size_t instants = 0;   ///< that tell

  /// By which the misfit falls with moments of its own.
  [[nodiscard]] double fall() const { return misfit_before / misfit_after; }
};

/// Cameras of a rig that moves smoothly, which fits no rigid rig and yet fits it when each of their
/// images has a moment of its own: shutters that run free. One number per image must pay: the
/// misfit's median falls to a fifth. Those that merely are late by a constant are told before
/// (explain_rig).
[[nodiscard]] std::vector<UnsynchronizedCamera> unsynchronized_cameras(const CameraTracks& tracks,
                                                                       const Extrinsics& stated);

/// The same of a capture, with the rig it states, as one error; their images are taken out of it,
/// for no rig holds them.
[[nodiscard]] std::optional<Finding> leave_out_unsynchronized(const CameraTracks& tracks,
                                                              DetectedCapture& capture);

}  // namespace waymark
