#include "mapbuilder/bundle/edge_bias.h"

#include <algorithm>

namespace waymark {

std::array<Eigen::Vector2d, 4> outward_of(const ImageCorners& corners) {
  std::array<Eigen::Vector2d, 4> normals;  // of the edge from corner i to i + 1
  const Eigen::Vector2d centre = (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d along = (corners[(i + 1) % 4] - corners[i]).normalized();
    normals[i] = Eigen::Vector2d(along.y(), -along.x());
    if (normals[i].dot(corners[i] - centre) < 0) normals[i] = -normals[i];
  }
  std::array<Eigen::Vector2d, 4> outward;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& a = normals[(i + 3) % 4];
    const Eigen::Vector2d& b = normals[i];
    outward[i] = (a + b) / std::max(0.1, 1.0 + a.dot(b));
  }
  return outward;
}

void move_edges_in(double bias_px, ImageCorners& corners) {
  if (bias_px == 0.0) return;
  const auto outward = outward_of(corners);
  for (std::size_t i = 0; i < 4; ++i) corners[i] -= bias_px * outward[i];
}

}  // namespace waymark
