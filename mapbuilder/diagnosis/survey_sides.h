#pragma once

#include <functional>
#include <optional>

#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/judged_survey.h"

namespace waymark {

/// What the rig's baselines say to sizes that are so many times those stated: true: they agree with
/// these, false: with the stated ones, nullopt: nothing. Asked only where sizes and survey differ.
using AskBaselines = std::function<std::optional<bool>(double sizes_times)>;

/// Holds a survey's fit entries against a map that was built without it. Where points stand against
/// each other: mirrored, at another corner, two exchanged, single ones off (agreement_of). Where
/// lengths stand: sizes, baselines, points and distances each state the scale; the side that most
/// witnesses agree with (sizes and baselines one each, points two from four on, every distance one)
/// is taken, and who stands alone is named with the factor. As many against as for: both remedies,
/// nothing is taken of the survey. Which way up is told by walls and cameras. All factors are over
/// the stated sizes; the map was built with `sizes_taken` times these.
[[nodiscard]] JudgedSurvey judge_survey(const Survey& survey, const BuildResult& without_it,
                                        const Observations& observations,
                                        const AskBaselines& ask_baselines,
                                        double sizes_taken = 1.0);

}  // namespace waymark
