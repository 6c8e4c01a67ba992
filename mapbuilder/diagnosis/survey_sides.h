#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/finding.h"

namespace waymark {

/// A survey without what contradicts the rest.
struct JudgedSurvey {
  Survey survey;  ///< entries that stand alone are left_out: they bend nothing
  std::vector<Finding> findings;
  /// What all stated sizes must be multiplied by, where more sides speak against them than for
  /// them; nullopt: they stand.
  std::optional<double> sizes_times;
  bool z_is_up = true;  ///< nothing says that the survey's third axis is another one
};

/// What the rig's baselines say to sizes that are so many times those stated: true: they agree with
/// these, false: with the stated ones, nullopt: nothing. Asked only where sizes and survey differ.
using AskBaselines = std::function<std::optional<bool>(double sizes_times)>;

/// Holds a survey's fit entries against a map that was built without it. Where points stand against
/// each other: mirrored, at another corner, two exchanged, single ones off (agreement_of). Where
/// lengths stand: sizes, baselines, points and distances each state the scale; the side that most
/// witnesses agree with (sizes and baselines one each, points two from four on, every distance one)
/// is taken, and who stands alone is named with the factor. As many against as for: both remedies,
/// nothing is taken of the survey. Which way up is told by walls and cameras.
[[nodiscard]] JudgedSurvey judge_survey(const Survey& survey, const BuildResult& without_it,
                                        const Observations& observations,
                                        const AskBaselines& ask_baselines);

}  // namespace waymark
