#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/camera_tracks.h"
#include "mapbuilder/diagnosis/rig_agreement.h"

namespace waymark {

/// Where a rig's cameras stand against its first one, by instants at which two of them stood at
/// places that one map tells; no marker need be seen by both. Camera after camera, each where most
/// of the instants that it shares with those before agree on it; then all together. nullopt for
/// one that shares fewer than three instants with them.
[[nodiscard]] std::vector<std::optional<Rigid3>> extrinsics_from_instants(
    const CameraTracks& tracks);

}  // namespace waymark
