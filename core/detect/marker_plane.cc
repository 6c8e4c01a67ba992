#include "core/detect/marker_plane.h"

#include <Eigen/Geometry>

#include "core/geometry/decompositions.h"

namespace waymark {

MarkerPlane::MarkerPlane(const CameraModel& camera, const Eigen::Vector3d& axis)
    : camera_(&camera),
      plane_from_cam_(shortest_rotation(axis, Eigen::Vector3d::UnitZ()).toRotationMatrix()) {}

std::optional<Eigen::Vector2d> MarkerPlane::plane_from_pixel(const Eigen::Vector2d& pixel) const {
  const auto bearing = camera_->bearing(pixel);
  if (!bearing) return std::nullopt;
  const Eigen::Vector3d turned = plane_from_cam_ * *bearing;
  constexpr double kMinCosine = 0.1;  // beyond 84° from the axis nothing is one marker
  if (turned.z() < kMinCosine) return std::nullopt;
  return Eigen::Vector2d(turned.hnormalized());
}

std::optional<Eigen::Vector2d> MarkerPlane::pixel_from_plane(const Eigen::Vector2d& point) const {
  return camera_->project(plane_from_cam_.transpose() * point.homogeneous());
}

std::optional<Eigen::Matrix2d> MarkerPlane::pixel_slope(const Eigen::Vector2d& point) const {
  const auto seen =
      camera_->project_with_jacobian(plane_from_cam_.transpose() * point.homogeneous());
  if (!seen) return std::nullopt;
  return Eigen::Matrix2d(seen->d_pixel_d_point * plane_from_cam_.transpose().leftCols<2>());
}

}  // namespace waymark
