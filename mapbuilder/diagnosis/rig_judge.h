#pragma once

#include <optional>

#include "core/camera/rig.h"
#include "mapbuilder/diagnosis/camera_tracks.h"
#include "mapbuilder/diagnosis/rig_explanation.h"
#include "mapbuilder/diagnosis/rig_fit.h"

namespace waymark {

/// Holds the stated rig against where its cameras stood, and names the simplest cause of what does
/// not fit: chain or link inverted, two exchanged, turned by a quarter or half, wrong unit, sizes
/// against baselines, clock, frames out of step, bumped on the way, displaced. nullopt when the
/// stated rig explains the tracks as well as any, or when no cause stands clearly above the others.
///
/// Every hypothesis predicts rig_from_cam of each camera and instant; the rig's pose is what most
/// cameras of the instant agree on; misfits count bounded (Welsch's loss at 6 sigmas), scaled by
/// the noise that the best hypothesis leaves. A hypothesis is priced by ln n per number that it
/// frees, and gains what it explains of the lenses that the images fit; each may use what `stated`
/// leaves open of the calibration.
[[nodiscard]] std::optional<RigExplanation> explain_rig(const CameraTracks& tracks,
                                                        const Rig& stated);

}  // namespace waymark
