#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/rig_hypothesis.h"

namespace waymark {

/// The camera was displaced at one moment; it fits the rig file before it, or after it.
[[nodiscard]] std::vector<RigHypothesis> bumped_hypotheses(const RigCase& rig, std::size_t camera);

/// The camera stands elsewhere throughout; nullopt where the others never tell.
[[nodiscard]] std::optional<RigHypothesis> displaced_hypothesis(const RigCase& rig,
                                                                std::size_t camera);

/// Several cameras stand elsewhere against the first; nullopt where none does.
[[nodiscard]] std::optional<RigHypothesis> all_displaced_hypothesis(const RigCase& rig);

}  // namespace waymark
