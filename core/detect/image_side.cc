#include "core/detect/image_side.h"

namespace waymark {

std::optional<ImageSide> ImageSide::create(const MarkerPlane& plane, const Eigen::Vector2d& start,
                                           const Eigen::Vector2d& end, double bow_px) {
  std::array<Eigen::Vector2d, 5> points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel =
        plane.pixel_from_plane(start + 0.25 * static_cast<double>(i) * (end - start));
    if (!pixel) return std::nullopt;
    points[i] = *pixel;
  }
  ImageSide side;
  side.start_px_ = points[0];
  side.length_px_ = (points[4] - points[0]).norm();
  if (!(side.length_px_ >= 1)) return std::nullopt;
  side.along_ = (points[4] - points[0]) / side.length_px_;
  side.outward_ = {side.along_.y(), -side.along_.x()};

  // The bend is zero at both ends; the rest is the parabola through three points between.
  std::array<double, 3> x;
  std::array<double, 3> y;
  for (std::size_t i = 0; i < 3; ++i) {
    x[i] = side.place(points[i + 1]);
    y[i] = side.outward_.dot(points[i + 1] - points[0]) / (x[i] * (1 - x[i]));
  }
  const double slope01 = (y[1] - y[0]) / (x[1] - x[0]);
  const double slope12 = (y[2] - y[1]) / (x[2] - x[1]);
  const double curvature = (slope12 - slope01) / (x[2] - x[0]);
  side.bend_ = {4 * bow_px + y[0] - x[0] * (slope01 - curvature * x[1]),
                slope01 - curvature * (x[0] + x[1]), curvature};
  return side;
}

}  // namespace waymark
