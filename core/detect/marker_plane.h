#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/camera/camera_model.h"

namespace waymark {

/// A plane in front of the camera across the line of sight to a marker, one unit away. There the
/// marker's sides are straight whatever the lens does, also beyond 90° from its axis.
class MarkerPlane {
 public:
  /// `axis`: unit direction (camera frame) from the camera to the marker.
  MarkerPlane(const CameraModel& camera, const Eigen::Vector3d& axis);

  /// nullopt where the camera sees nothing, or across the marker's direction.
  [[nodiscard]] std::optional<Eigen::Vector2d> plane_from_pixel(const Eigen::Vector2d& pixel) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_from_plane(const Eigen::Vector2d& point) const;

  /// d pixel / d point of the plane; nullopt where the camera does not see the point.
  [[nodiscard]] std::optional<Eigen::Matrix2d> pixel_slope(const Eigen::Vector2d& point) const;

 private:
  const CameraModel* camera_;
  Eigen::Matrix3d plane_from_cam_;
};

}  // namespace waymark
