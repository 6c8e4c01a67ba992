#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/rig_hypothesis.h"

namespace waymark {

/// The camera's images are older or newer than stamped by a constant time; nullopt where the rig
/// does not move smoothly, which tells nothing of clocks.
[[nodiscard]] std::optional<RigHypothesis> late_hypothesis(const RigCase& rig, std::size_t camera);

/// From a frame set on the camera shows what the others saw one to three frames earlier or later.
[[nodiscard]] std::vector<RigHypothesis> out_of_step_hypotheses(const RigCase& rig,
                                                                std::size_t camera);

}  // namespace waymark
