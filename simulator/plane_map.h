#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include "core/geometry/rigid3.h"

namespace waymark::simulator {

/// Where a camera's rays meet a plane. For a direction d in the camera frame the plane coordinates
/// of the hit are (across·d / depth·d, above·d / depth·d); the ray hits the plane's front iff
/// depth·d < 0, and −depth·d / eye_height is the inverse distance in units of |d|.
struct PlaneMap {
  Eigen::Vector3f across = Eigen::Vector3f::Zero();
  Eigen::Vector3f above = Eigen::Vector3f::Zero();
  Eigen::Vector3f depth = Eigen::Vector3f::Zero();
  float eye_height = 0;  ///< of the camera above the plane's front; ≤ 0: behind it, nothing is seen

  /// Coordinates count from `world_from_plane`'s origin along its x and y axes, in units of
  /// `unit_m`.
  static PlaneMap of(const Rigid3& world_from_plane, const Rigid3& world_from_cam, double unit_m) {
    const Rigid3 plane_from_cam = world_from_plane.inverse() * world_from_cam;
    const Eigen::Matrix3d r = plane_from_cam.rotation.toRotationMatrix();
    const Eigen::Vector3d eye = plane_from_cam.translation / unit_m;
    const Eigen::RowVector3d across = eye.x() * r.row(2) - eye.z() * r.row(0);
    const Eigen::RowVector3d above = eye.y() * r.row(2) - eye.z() * r.row(1);
    return {across.transpose().cast<float>(), above.transpose().cast<float>(),
            r.row(2).transpose().cast<float>(), static_cast<float>(eye.z() * unit_m)};
  }

  /// Between two instants that are close in time.
  static PlaneMap between(const PlaneMap& a, const PlaneMap& b, float share) {
    return {a.across + share * (b.across - a.across), a.above + share * (b.above - a.above),
            a.depth + share * (b.depth - a.depth),
            a.eye_height + share * (b.eye_height - a.eye_height)};
  }
};

}  // namespace waymark::simulator
