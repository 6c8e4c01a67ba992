#pragma once

#include <cstddef>
#include <vector>

namespace waymark::simulator {

/// The lens's Gaussian blur and the pixel's square aperture together, as weights of sub-pixels:
/// optics first, then collection, as in a camera. Blurring finished pixels instead would make an
/// edge's profile depend on where in a pixel it lies.
class PointSpread {
 public:
  /// `sigma_px` of the lens alone, `oversampling` sub-pixels per pixel along an axis.
  PointSpread(double sigma_px, int oversampling);

  /// Pixels around a pixel from which it draws light.
  [[nodiscard]] static int radius_px(double sigma_px);

  /// Reduces one row of sub-pixels to `count` pixels. Phase p of the row, [p·stride, p·stride +
  /// count + 2·radius), holds sub-pixel p of each pixel, from `radius` pixels left of the first on.
  void reduce_row(const float* phases, std::size_t stride, std::size_t count, float* out) const;

  /// Reduces `rows` rows of sub-pixels (each of `count` values, `stride` apart), the first of them
  /// `radius` pixels above, to one row of pixels.
  void reduce_column(const float* rows, std::size_t stride, std::size_t count, float* out) const;

  [[nodiscard]] int oversampling() const { return oversampling_; }

 private:
  int oversampling_;
  std::vector<float> weights_;  ///< (2·radius + 1)·oversampling of them, sum 1
};

}  // namespace waymark::simulator
