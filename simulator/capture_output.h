#pragma once

#include <filesystem>
#include <string>

#include "core/base/error.h"
#include "simulator/capture_plan.h"
#include "simulator/rig_library.h"
#include "simulator/scene.h"

namespace waymark::simulator {

/// Writes what a simulated capture says of itself into its folder: rig.yaml, markers.toml,
/// capture.toml, frames.csv and groundtruth/. Transforms are left out of rig.yaml when the rig is
/// mono; then groundtruth/ also has rig.camN.tum (world_from_cam).
[[nodiscard]] Status write_description(const std::filesystem::path& folder, const Scene& scene,
                                       const SimulatedRig& rig, const CapturePlan& plan,
                                       double exposure_s, const std::string& session);

}  // namespace waymark::simulator
