#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace waymark {

/// [v]× with [v]× w = v × w.
[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Exp: rotation vector (rad) → unit quaternion. Exact at and near zero.
[[nodiscard]] Eigen::Quaterniond so3_exp(const Eigen::Vector3d& rotation_vector_rad);

/// Log: unit quaternion → rotation vector (rad) of norm ≤ π. q and −q give the same.
[[nodiscard]] Eigen::Vector3d so3_log(const Eigen::Quaterniond& q);

/// Geodesic distance (rad, in [0, π]) between two rotations.
[[nodiscard]] double angle_between_rad(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

}  // namespace waymark
