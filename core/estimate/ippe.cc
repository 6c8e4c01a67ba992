#include "core/estimate/ippe.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/decompositions.h"
#include "core/geometry/square_homography.h"
#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

using Points2 = std::array<Eigen::Vector2d, 4>;

/// Homography from the square's corners (±1, ±1; order of `Corner`) to `q`, h33 = 1 at the centre.
std::optional<Eigen::Matrix3d> homography_from_square(const Points2& q) {
  const auto from_unit = homography_from_unit_square({q[3], q[2], q[1], q[0]});
  if (!from_unit) return std::nullopt;
  Eigen::Matrix3d unit_from_square;
  unit_from_square << 0.5, 0, 0.5, 0, 0.5, 0.5, 0, 0, 1;
  const Eigen::Matrix3d result = *from_unit * unit_from_square;
  if (std::abs(result(2, 2)) < 1e-12) return std::nullopt;
  return result / result(2, 2);
}

/// Rotation that turns the z axis into `direction` (unit) the short way.
Eigen::Matrix3d rotation_from_z_to(const Eigen::Vector3d& direction) {
  return shortest_rotation(Eigen::Vector3d::UnitZ(), direction).toRotationMatrix();
}

/// Translation that best explains the corners for a given rotation: linear least squares of
/// q·(r₃·X + t₃) = r₁₂·X + t₁₂.
Eigen::Vector3d best_translation(const Eigen::Matrix3d& rotation, const Points2& q,
                                 const std::array<Eigen::Vector3d, 4>& x_in_marker) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d turned = rotation * x_in_marker[i];
    Eigen::Matrix<double, 2, 3> a;
    a << 1, 0, -q[i].x(), 0, 1, -q[i].y();
    const Eigen::Vector2d b(q[i].x() * turned.z() - turned.x(), q[i].y() * turned.z() - turned.y());
    normal += a.transpose() * a;
    right += a.transpose() * b;
  }
  return SymmetricFactor<3>(normal).solve(right);
}

double reprojection_rms_px(const CameraModel& camera, const Rigid3& cam_from_marker,
                           const ImageCorners& corners_px,
                           const std::array<Eigen::Vector3d, 4>& x_in_marker) {
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = camera.project(cam_from_marker * x_in_marker[i]);
    if (!pixel) return std::numeric_limits<double>::infinity();
    sum += (*pixel - corners_px[i]).squaredNorm();
  }
  return std::sqrt(sum / 4.0);
}

/// Both rotations of IPPE (section 4 of its paper) from the homography's value and Jacobian at the
/// centre.
std::optional<std::array<Eigen::Matrix3d, 2>> ippe_rotations(const Eigen::Matrix3d& h) {
  const Eigen::Vector2d v(h(0, 2), h(1, 2));
  Eigen::Matrix2d j;
  j << h(0, 0) - h(2, 0) * v.x(), h(0, 1) - h(2, 1) * v.x(),  //
      h(1, 0) - h(2, 0) * v.y(), h(1, 1) - h(2, 1) * v.y();

  const Eigen::Matrix3d rv = rotation_from_z_to(Eigen::Vector3d(v.x(), v.y(), 1).normalized());
  Eigen::Matrix<double, 2, 3> p;
  p << 1, 0, -v.x(), 0, 1, -v.y();
  const Eigen::Matrix2d b = (p * rv).leftCols<2>();
  const Eigen::Matrix2d a = b.inverse() * j;
  const double gamma = largest_singular_value(a);
  if (!(gamma > 1e-12) || !std::isfinite(gamma)) return std::nullopt;

  const Eigen::Matrix2d r22 = a / gamma;
  const Eigen::Matrix2d rest = Eigen::Matrix2d::Identity() - r22.transpose() * r22;
  const double b0 = std::sqrt(std::max(0.0, rest(0, 0)));
  const double b1 = std::copysign(std::sqrt(std::max(0.0, rest(1, 1))), rest(0, 1));

  std::array<Eigen::Matrix3d, 2> rotations;
  for (std::size_t i = 0; i < 2; ++i) {
    const double sign = i == 0 ? 1.0 : -1.0;
    Eigen::Matrix3d m;
    m.col(0) << r22(0, 0), r22(1, 0), sign * b0;
    m.col(1) << r22(0, 1), r22(1, 1), sign * b1;
    m.col(2) = m.col(0).cross(m.col(1));
    // Rounding and noise leave it a little off; the quaternion makes it a rotation again.
    rotations[i] = rv * Eigen::Quaterniond(m).normalized().toRotationMatrix();
  }
  return rotations;
}

}  // namespace

std::optional<IppeSolutions> solve_ippe(const CameraModel& camera, const ImageCorners& corners_px,
                                        double size_m) {
  std::array<Eigen::Vector3d, 4> directions;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    const auto direction = camera.bearing(corners_px[i]);
    if (!direction) return std::nullopt;
    directions[i] = *direction;
    mean += *direction;
  }
  if (mean.norm() < 1e-6) return std::nullopt;
  const Eigen::Matrix3d cam_from_virtual = rotation_from_z_to(mean.normalized());

  Points2 q;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d x = cam_from_virtual.transpose() * directions[i];
    if (x.z() < 1e-3) return std::nullopt;
    q[i] = x.head<2>() / x.z();
  }
  const auto homography = homography_from_square(q);
  if (!homography) return std::nullopt;
  // y up in the marker against y down in the image: a front view has a negative determinant.
  if (homography->determinant() >= 0) return std::nullopt;
  const double half_m = 0.5 * size_m;
  const auto rotations = ippe_rotations(*homography);
  if (!rotations) return std::nullopt;

  IppeSolutions solutions;
  const auto x_in_marker = marker_corners(2.0 * half_m);
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Vector3d t = best_translation((*rotations)[i], q, x_in_marker);
    solutions.cam_from_marker[i] = {
        Eigen::Quaterniond(Eigen::Matrix3d(cam_from_virtual * (*rotations)[i])).normalized(),
        cam_from_virtual * t};
    solutions.rms_px[i] =
        reprojection_rms_px(camera, solutions.cam_from_marker[i], corners_px, x_in_marker);
  }
  if (solutions.rms_px[1] < solutions.rms_px[0]) {
    std::swap(solutions.cam_from_marker[0], solutions.cam_from_marker[1]);
    std::swap(solutions.rms_px[0], solutions.rms_px[1]);
  }
  if (!std::isfinite(solutions.rms_px[0])) return std::nullopt;
  return solutions;
}

}  // namespace waymark
