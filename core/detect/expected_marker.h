#pragma once

#include "core/detect/image_window.h"
#include "core/marker/marker_geometry.h"
#include "core/marker/marker_id.h"

namespace waymark {

/// Where a marker is expected in an image.
struct ExpectedMarker {
  MarkerId marker;
  ImageCorners corners;  ///< px
  double reach_px = 0;   ///< how far off it may be, along either axis
};

/// What of the image to look at for it: as far as it may be off, and some light around it.
[[nodiscard]] ImageWindow window_of(const ExpectedMarker& expected);

}  // namespace waymark
