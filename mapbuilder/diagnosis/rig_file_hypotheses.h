#pragma once

#include <vector>

#include "mapbuilder/diagnosis/rig_hypothesis.h"

namespace waymark {

/// The ways in which a rig file is easily written wrongly, in the order in which a person would
/// check: chain, link or body transform the other way round, two cameras exchanged, all or one
/// turned by a quarter or half about the optical axis.
[[nodiscard]] std::vector<RigHypothesis> rig_file_hypotheses(const RigCase& rig);

}  // namespace waymark
