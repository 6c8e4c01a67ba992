#include "core/detect/smallest_rectangle.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace waymark {
namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Corners of the convex hull in order (Andrew's monotone chain).
std::vector<Vector2d> hull_of(std::span<const Pixel> pixels) {
  std::vector<Vector2d> points;
  for (const Pixel& pixel : pixels) points.emplace_back(pixel.x, pixel.y);
  const auto less = [](const Vector2d& a, const Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  };
  std::sort(points.begin(), points.end(), less);
  std::vector<Vector2d> hull;
  const auto add_half = [&] {
    const std::size_t first = hull.size();
    for (const Vector2d& point : points) {
      while (hull.size() >= first + 2 &&
             cross(hull.back() - hull[hull.size() - 2], point - hull[hull.size() - 2]) <= 0) {
        hull.pop_back();
      }
      hull.push_back(point);
    }
    hull.pop_back();  // it begins the other half
  };
  add_half();
  std::reverse(points.begin(), points.end());
  add_half();
  return hull;
}

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double length() const { return high - low; }
};

}  // namespace

std::optional<ImageCorners> smallest_rectangle(std::span<const Pixel> pixels) {
  if (pixels.size() < 3) return std::nullopt;
  const std::vector<Vector2d> hull = hull_of(pixels);
  if (hull.size() < 3) return std::nullopt;
  double least = std::numeric_limits<double>::infinity();
  ImageCorners best;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector2d along = (hull[(i + 1) % hull.size()] - hull[i]).normalized();
    const Vector2d across(-along.y(), along.x());
    Extent x;
    Extent y;
    for (const Vector2d& point : hull) {
      x.add(along.dot(point));
      y.add(across.dot(point));
    }
    if (x.length() * y.length() >= least) continue;
    least = x.length() * y.length();
    // From the outermost pixels' middles to their edges.
    const double left = x.low - 0.5;
    const double right = x.high + 0.5;
    const double top = y.low - 0.5;
    const double bottom = y.high + 0.5;
    best = {left * along + top * across, right * along + top * across,
            right * along + bottom * across, left * along + bottom * across};
  }
  return best;
}

}  // namespace waymark
