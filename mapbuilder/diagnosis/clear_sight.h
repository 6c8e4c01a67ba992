#pragma once

#include "mapbuilder/diagnosis/map_evidence.h"

namespace waymark {

/// Whether a camera of a frame set would have shown a marker at this place: it lies whole in the
/// image, at least `least_side_px` large and within 60° of its normal, and another marker is seen
/// beside it (within four sides in the image) that is no nearer: nothing stands in between. A
/// marker that is not found there is not there. False where nothing can be told.
[[nodiscard]] bool has_clear_sight(const MapEvidence& evidence, FrameSetIndex frame_set,
                                   const SizedPlace& place, double least_side_px);

}  // namespace waymark
