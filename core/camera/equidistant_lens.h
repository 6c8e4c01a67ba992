#pragma once

#include "core/camera/camera_model.h"
#include "core/camera/lens_image.h"

namespace waymark {

/// Kannala and Brandt's θd = θ(1 + k1θ² + k2θ⁴ + k3θ⁶ + k4θ⁸), θ the angle from the axis.
struct EquidistantLens {
  static constexpr int kCoefficients = 4;

  /// The angle (rad) up to which the polynomial grows, ≤ π.
  static double domain_end(const LensCoefficients& k) {
    return end_of_positive([&](double theta) { return distorted_angle(k, theta).second; },
                           std::numbers::pi);
  }

  /// Image radius there, in focal lengths.
  static double image_end(const LensCoefficients& k, double end) {
    return distorted_angle(k, end).first;
  }

  static std::optional<Eigen::Vector2d> position(const LensCoefficients& k, double end,
                                                 const Eigen::Vector3d& x_in_cam) {
    const auto there = image(k, end, x_in_cam);
    if (!there) return std::nullopt;
    return there->position;
  }

  static std::optional<LensImage<4>> image(const LensCoefficients& k, double end,
                                           const Eigen::Vector3d& x_in_cam) {
    const Eigen::Vector2d side = x_in_cam.head<2>();
    const double z = x_in_cam.z();
    const double rho = side.norm();
    const double n2 = rho * rho + z * z;
    const double theta = std::atan2(rho, z);
    if (!(n2 > 0 && std::isfinite(n2) && theta < end)) return std::nullopt;
    const auto [angle, slope] = distorted_angle(k, theta);
    // position = side · scale with scale = θd/ρ; d scale / d side = side · curl.
    const bool on_axis = rho < 1e-9 * z;
    const double scale = on_axis ? 1 / z : angle / rho;
    const double curl =
        on_axis ? (2 * k[0] - 2.0 / 3.0) / (z * z * z) : (slope * z / n2 - scale) / (rho * rho);
    LensImage<4> image;
    image.position = scale * side;
    image.d_point.leftCols<2>() =
        scale * Eigen::Matrix2d::Identity() + curl * side * side.transpose();
    image.d_point.col(2) = -slope / n2 * side;
    const double t2 = theta * theta;
    const Eigen::Vector2d cubic = (on_axis ? t2 / z : theta * t2 / rho) * side;
    image.d_coefficients << cubic, cubic * t2, cubic * (t2 * t2), cubic * (t2 * t2 * t2);
    return image;
  }

  static std::optional<Eigen::Vector3d> bearing(const LensCoefficients& k, double end,
                                                const Eigen::Vector2d& position) {
    const double distance = position.norm();
    const auto theta =
        invert_increasing([&](double t) { return distorted_angle(k, t); }, distance, end);
    if (!theta || *theta >= end) return std::nullopt;
    if (distance == 0) return Eigen::Vector3d(0, 0, 1);
    const Eigen::Vector2d side = position * (std::sin(*theta) / distance);
    return Eigen::Vector3d(side.x(), side.y(), std::cos(*theta));
  }

 private:
  /// Distorted angle and its slope.
  static std::pair<double, double> distorted_angle(const LensCoefficients& k, double theta) {
    const double t2 = theta * theta;
    const double value = theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
    const double slope = 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
    return {value, slope};
  }
};

}  // namespace waymark
