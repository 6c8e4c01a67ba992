#include "simulator/ray_table.h"

namespace waymark::simulator {

RayTable::RayTable(const CameraModel& camera, int padding_px)
    : padding_px_(padding_px),
      width_px_(camera.parameters().width_px),
      height_px_(camera.parameters().height_px),
      row_length_(static_cast<std::size_t>(width_px_ + 2 * padding_px + 1)) {
  const std::size_t count = row_length_ * static_cast<std::size_t>(height_px_ + 2 * padding_px + 1);
  x_.reserve(count);
  y_.reserve(count);
  z_.reserve(count);
  for (int j = -padding_px; j <= height_px_ + padding_px; ++j) {
    for (int i = -padding_px; i <= width_px_ + padding_px; ++i) {
      const Eigen::Vector3d ray =
          camera.bearing({i - 0.5, j - 0.5}).value_or(Eigen::Vector3d::Zero());
      x_.push_back(static_cast<float>(ray.x()));
      y_.push_back(static_cast<float>(ray.y()));
      z_.push_back(static_cast<float>(ray.z()));
    }
  }
}

RayTable::Row RayTable::row(int corner_y) const {
  const std::size_t start = static_cast<std::size_t>(corner_y + padding_px_) * row_length_;
  return {x_.data() + start, y_.data() + start, z_.data() + start};
}

}  // namespace waymark::simulator
