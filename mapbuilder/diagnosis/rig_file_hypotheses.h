#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/rig_hypothesis.h"

namespace waymark {

/// The ways in which a rig file is easily written wrongly, in the order in which a person would
/// check: chain, link or body transform the other way round, two cameras exchanged, all or one
/// turned by a quarter or half about the optical axis.
[[nodiscard]] std::vector<RigHypothesis> rig_file_hypotheses(const RigCase& rig);

/// Two cameras whose images are exchanged, told by where displaced cameras were found to stand: the
/// other's lens bends what a camera's images tell of its place, so that they fit the exchanged
/// places by more than chance only. nullopt: they stand where no exchange puts them.
[[nodiscard]] std::optional<RigHypothesis> exchanged_hypothesis(const RigCase& rig,
                                                                const RigHypothesis& displaced);

}  // namespace waymark
