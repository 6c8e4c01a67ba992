#pragma once

#include <string>

#include "core/base/error.h"
#include "core/camera/rig.h"

namespace waymark::simulator {

/// What is mounted on the vehicle, and what its capture tells of it.
struct SimulatedRig {
  std::string name;
  Rig rig;  ///< with the true extrinsics; the rig frame is cam0's unless the camchain says
            ///< otherwise
  bool mono = false;  ///< the capture's rig.yaml has no transforms: every image stands for itself
};

/// "cg60" (looking ahead, 60° left, 60° right), "cg120" (120° apart), "cg180" (two, back to back),
/// "mono" (cg120's cameras, each for itself), or a camchain file. Cameras: the paper's 1224 × 1024
/// px, 39.56° × 33.49°, with a lens distortion of their own, 0.1 m from the rig's axis. no_input
/// when it is neither; bad_data for a camchain that can't be used, as one without cameras or, with
/// several cameras, without transforms.
[[nodiscard]] Expected<SimulatedRig> load_rig(const std::string& name_or_file);

}  // namespace waymark::simulator
