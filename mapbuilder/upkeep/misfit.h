#pragma once

#include <vector>

#include "mapbuilder/build/frame_comparison.h"

namespace waymark {

/// Sigmas by which two maps differ that are no chance any more, which leaves 1 ± 0.2.
inline constexpr double kPoorSigmas = 2.0;

/// By what markers that stayed differ, in what both maps' sigmas say: the median distance against
/// that of three normal coordinates, so that half of them may have been pressed on again. At least
/// 1; of fewer than 5 markers with known sigmas 1, for they don't tell.
[[nodiscard]] double misfit_sigmas(const std::vector<ComparedMarker>& stayed);

/// Whether a marker that stayed lies off by more than five of its sigmas at this misfit.
[[nodiscard]] bool is_shifted(const ComparedMarker& marker, double misfit);

/// Where sigmas don't hold, who is not shifted by them, nor turned beyond MovedLimits, has not
/// moved: such markers of a comparison go to those that stayed.
void acquit(FrameComparison& comparison, double misfit);

}  // namespace waymark
