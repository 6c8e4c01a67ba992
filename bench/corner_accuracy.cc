#include "bench/corner_accuracy.h"

#include <Eigen/LU>
#include <array>
#include <cmath>

namespace waymark {
namespace {

/// Outward unit normals of the edges from corner i to the next one. Seen from the front, corners
/// run clockwise in an image with y down.
std::array<Eigen::Vector2d, 4> outward_normals(const ImageCorners& corners) {
  std::array<Eigen::Vector2d, 4> normals;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d along = (corners[(i + 1) % 4] - corners[i]).normalized();
    normals[i] = {along.y(), -along.x()};
  }
  return normals;
}

}  // namespace

ImageCorners with_edges_moved(const ImageCorners& truth, double offset_px) {
  const auto normals = outward_normals(truth);
  ImageCorners moved = truth;
  for (std::size_t i = 0; i < 4; ++i) {
    Eigen::Matrix2d both_edges;
    both_edges << normals[(i + 3) % 4].transpose(), normals[i].transpose();
    moved[i] += both_edges.inverse() * Eigen::Vector2d(offset_px, offset_px);
  }
  return moved;
}

double edge_offset_px(const CornerPair& marker) {
  const auto normals = outward_normals(marker.truth);
  double sum = 0;
  double perimeter_px = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = (i + 1) % 4;
    const double length_px = (marker.truth[next] - marker.truth[i]).norm();
    perimeter_px += length_px;
    for (const std::size_t corner : {i, next}) {
      sum += 0.5 * length_px * normals[i].dot(marker.found[corner] - marker.truth[corner]);
    }
  }
  return sum / perimeter_px;
}

CornerAccuracy corner_accuracy(std::span<const CornerPair> markers) {
  CornerAccuracy accuracy;
  if (markers.empty()) return accuracy;
  const auto count = static_cast<double>(markers.size());
  for (const CornerPair& marker : markers) {
    accuracy.edge_bias_px += edge_offset_px(marker) / count;
  }
  double squares = 0;
  double squares_without_bias = 0;
  for (const CornerPair& marker : markers) {
    const ImageCorners biased = with_edges_moved(marker.truth, accuracy.edge_bias_px);
    for (std::size_t i = 0; i < 4; ++i) {
      squares += (marker.found[i] - marker.truth[i]).squaredNorm();
      squares_without_bias += (marker.found[i] - biased[i]).squaredNorm();
    }
  }
  accuracy.sigma_px = std::sqrt(squares_without_bias / (8 * count));
  accuracy.rms_px = std::sqrt(squares / (4 * count));
  return accuracy;
}

}  // namespace waymark
