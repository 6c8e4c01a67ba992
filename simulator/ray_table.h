#pragma once

#include <cstddef>
#include <vector>

#include "core/camera/camera_model.h"

namespace waymark::simulator {

/// Viewing directions of one camera at all pixel corners, so that rendering needs no iterative
/// undistortion. Corner (i, j) is the image point (i − 0.5, j − 0.5) px; corners reach `padding_px`
/// beyond the image, because the point spread draws light from there.
class RayTable {
 public:
  RayTable(const CameraModel& camera, int padding_px);

  /// A row of directions in the camera frame, unit, from corner x = −padding_px on; (0, 0, 0) where
  /// no direction of the lens leads to the corner.
  struct Row {
    const float* x;
    const float* y;
    const float* z;
  };
  [[nodiscard]] Row row(int corner_y) const;

  [[nodiscard]] int padding_px() const { return padding_px_; }
  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }

 private:
  int padding_px_;
  int width_px_, height_px_;
  std::size_t row_length_;
  std::vector<float> x_, y_, z_;
};

}  // namespace waymark::simulator
