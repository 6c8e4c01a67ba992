#include "core/marker/marker_outline.h"

#include <algorithm>

namespace waymark {
namespace {

/// Outward unit normals of the sides from corner i to i + 1.
std::array<Eigen::Vector2d, 4> normals_of(const ImageCorners& corners) {
  std::array<Eigen::Vector2d, 4> normals;
  const Eigen::Vector2d centre = centre_of(corners);
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d along = (corners[(i + 1) % 4] - corners[i]).normalized();
    normals[i] = Eigen::Vector2d(along.y(), -along.x());
    if (normals[i].dot(corners[i] - centre) < 0) normals[i] = -normals[i];
  }
  return normals;
}

}  // namespace

Eigen::Vector2d centre_of(const ImageCorners& corners) {
  return (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0;
}

double mean_side_px(const ImageCorners& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += 0.25 * (corners[(i + 1) % 4] - corners[i]).norm();
  return sum;
}

std::array<Eigen::Vector2d, 4> outward_of(const ImageCorners& corners) {
  const auto normals = normals_of(corners);
  std::array<Eigen::Vector2d, 4> outward;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& a = normals[(i + 3) % 4];
    const Eigen::Vector2d& b = normals[i];
    outward[i] = (a + b) / std::max(0.1, 1.0 + a.dot(b));
  }
  return outward;
}

void move_sides_in(double px, ImageCorners& corners) {
  if (px == 0.0) return;
  const auto outward = outward_of(corners);
  for (std::size_t i = 0; i < 4; ++i) corners[i] -= px * outward[i];
}

double inset_px(const ImageCorners& given, const ImageCorners& black) {
  const auto normals = normals_of(black);
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = (i + 1) % 4;
    sum += 0.125 * normals[i].dot(black[i] + black[next] - given[i] - given[next]);
  }
  return sum;
}

}  // namespace waymark
