#pragma once

#include <memory>
#include <vector>

#include "core/base/error.h"
#include "core/capture/detection.h"
#include "core/capture/gray_image.h"
#include "core/marker/family.h"

namespace waymark {

/// Finds and decodes markers: the seam behind which OpenCV's or libapriltag's detector stands.
/// Corners are rough (about ±1 px), in the order and pixel convention of `ImageCorners`
/// (pixel centre at integers); refine_corners makes them exact. One detector per thread.
class MarkerDetector {
 public:
  virtual ~MarkerDetector() = default;
  /// All markers of the detector's families, by rising (id, first corner); no covariances yet. The same id may
  /// appear twice.
  [[nodiscard]] virtual std::vector<Detection> detect(const GrayView& image) = 0;
};

}  // namespace waymark
