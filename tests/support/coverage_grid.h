#pragma once

#include <Eigen/Core>
#include <vector>

namespace waymark::testing {

/// Pixels [left, right) × [top, bottom).
struct PixelBox {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
};

/// Light that polygons spread over a box of pixels, integrated exactly over sub-pixels: signed
/// areas of trapezoids are accumulated edge by edge (the way font rasterizers do).
class CoverageGrid {
 public:
  CoverageGrid(const PixelBox& box, int oversampling);

  /// Adds `light` inside the polygon, clockwise as seen in the image, pixel centres at integers.
  /// It must lie inside the box.
  void add(const std::vector<Eigen::Vector2d>& polygon, double light);

  /// Blurs with a Gaussian, averages over each pixel, adds to the part of `image` (rows of
  /// `width_px` pixels) that the box covers.
  void integrate_into(double psf_sigma_px, int width_px, std::vector<double>& image) const;

 private:
  void add_edge(Eigen::Vector2d from, Eigen::Vector2d to, double light);

  PixelBox box_;
  int oversampling_;
  int columns_;
  int rows_;
  std::vector<double> steps_;  ///< running sums along rows are the light
};

}  // namespace waymark::testing
