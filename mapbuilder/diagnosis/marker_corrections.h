#pragma once

#include <span>

#include "mapbuilder/diagnosis/marker_diagnosis.h"

namespace waymark {

/// What a diagnosis of the selection changes so that what is wrong can't harm the rest: wrong ids
/// are left out, and markers that are not square; so is a marker that stands twice, or as much of
/// it as belongs to the place that the map does not keep; wrong sizes are replaced by the fitted
/// ones.
[[nodiscard]] Corrections corrections_for(const Selection& selection,
                                          std::span<const MarkerDiagnosis> diagnoses);

}  // namespace waymark
