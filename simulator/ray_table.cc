#include "simulator/ray_table.h"

#include <algorithm>

namespace waymark::simulator {
namespace {

/// Corners between which directions are interpolated. A lens with |k1| = 0.1 at f = 1700 px bends a
/// straight line by 3e-4 px over 4 px.
constexpr int kStep_px = 4;

}  // namespace

RayTable::RayTable(const CameraModel& camera, int padding_px)
    : padding_px_(padding_px),
      width_px_(camera.parameters().width_px),
      height_px_(camera.parameters().height_px),
      row_length_(static_cast<std::size_t>(width_px_ + 2 * padding_px + 1)) {
  const int columns = width_px_ + 2 * padding_px + 1;
  const int rows = height_px_ + 2 * padding_px + 1;
  const int node_columns = (columns - 1) / kStep_px + 2;
  const auto node_row = [&](int row) {
    std::vector<Eigen::Vector3f> directions;
    for (int k = 0; k < node_columns; ++k) {
      const Eigen::Vector2d corner(k * kStep_px - padding_px - 0.5, row - padding_px - 0.5);
      const auto direction = camera.bearing(corner);
      directions.push_back(direction.value_or(Eigen::Vector3d::Zero()).cast<float>());
    }
    return directions;
  };
  const std::size_t count = row_length_ * static_cast<std::size_t>(rows);
  x_.reserve(count);
  y_.reserve(count);
  z_.reserve(count);
  std::vector<Eigen::Vector3f> upper;
  std::vector<Eigen::Vector3f> lower = node_row(0);
  for (int j = 0; j < rows; ++j) {
    if (j % kStep_px == 0) {
      upper = std::move(lower);
      lower = node_row(j + kStep_px);
    }
    const float down = static_cast<float>(j % kStep_px) / kStep_px;
    for (int i = 0; i < columns; ++i) {
      const auto k = static_cast<std::size_t>(i / kStep_px);
      const float right = static_cast<float>(i % kStep_px) / kStep_px;
      const Eigen::Vector3f ray = (1 - down) * ((1 - right) * upper[k] + right * upper[k + 1]) +
                                  down * ((1 - right) * lower[k] + right * lower[k + 1]);
      x_.push_back(ray.x());
      y_.push_back(ray.y());
      z_.push_back(ray.z());
    }
  }
}

RayTable::Row RayTable::row(int corner_y) const {
  const std::size_t start = static_cast<std::size_t>(corner_y + padding_px_) * row_length_;
  return {x_.data() + start, y_.data() + start, z_.data() + start};
}

}  // namespace waymark::simulator
