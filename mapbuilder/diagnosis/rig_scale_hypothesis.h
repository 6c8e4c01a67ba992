#pragma once

#include <optional>

#include "mapbuilder/diagnosis/rig_hypothesis.h"

namespace waymark {

/// Baselines are longer or shorter than the cameras stand apart by one factor: translations in
/// another unit, or sizes against baselines.
[[nodiscard]] RigHypothesis rig_scale_hypothesis(const RigCase& rig);

}  // namespace waymark
