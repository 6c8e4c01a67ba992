#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "mapbuilder/build/build_options.h"
#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// How a rig is calibrated.
struct RigCalibrationOptions {
  std::optional<Distortion> lens;  ///< of every camera; nullopt: what the evidence says, each
  BuildOptions build;              ///< threads, loss, gate; what is refined is not asked here
};

/// A rig near the true one: what a refinement may begin with.
struct FoundRig {
  Rig rig;                          ///< without transforms where cameras could not be linked
  std::vector<std::string> lenses;  ///< per camera, the evidence for its kind of lens
  std::vector<Finding> findings;    ///< what could not be told
};

/// Finds the cameras of a rig from captures of a place with markers, all of the same rig, whose
/// stated numbers are but one start: each camera's lens from its own images (grow_lens), then, in a
/// common map of every image on its own, the cameras' places from the instants that they share
/// (extrinsics_from_instants); no common view is needed. The rig's frame is where its first camera
/// has it. Errors: bad_data, with the reason, where captures are of different rigs, or a camera
/// sees no two markers together; usage without captures.
[[nodiscard]] Expected<FoundRig> find_rig(std::vector<DetectedCapture> captures,
                                          const RigCalibrationOptions& options, Progress& progress);

}  // namespace waymark
