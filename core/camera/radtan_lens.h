#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "core/camera/camera_model.h"
#include "core/camera/lens_image.h"

namespace waymark {

/// Brown's lens as OpenCV has it, on n = (x/z, y/z) with r = |n|:
///   n' = n (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶)
///        + (2 p1 x y + p2 (r² + 2x²), p1 (r² + 2y²) + 2 p2 x y),
/// coefficients k1 k2 p1 p2 k3 k4 k5 k6, of which the first kCount are there: 4, 5 or 8.
template <int kCount>
struct RadtanLens {
  static_assert(kCount == 4 || kCount == 5 || kCount == 8);
  static constexpr int kCoefficients = kCount;

  /// The largest disc (radius of n) on which the distortion is one-to-one: where its (symmetric)
  /// slope is positive definite, for then it is the gradient of a convex potential. The slope's
  /// eigenvalues are those of the radial part, d(r·factor)/dr and the factor, less at most
  /// 6|(p₁, p₂)|r.
  static double domain_end(const LensCoefficients& k) {
    const double tangential = 6 * std::hypot(k[2], k[3]);
    const auto least_slope = [&](double angle) {
      const double r = std::tan(angle);
      double least = std::min(radial(k, r).second, factor_of(k, r * r)) - tangential * r;
      if constexpr (kCount == 8) least = std::min(least, denominator(k, r * r));
      return least;
    };
    return std::tan(end_of_positive(least_slope, kMaxPinholeAngle));
  }

  /// Image radius there, in focal lengths.
  static double image_end(const LensCoefficients& k, double end) { return radial(k, end).first; }

  static std::optional<Eigen::Vector2d> position(const LensCoefficients& k, double end,
                                                 const Eigen::Vector3d& x_in_cam) {
    const Eigen::Vector2d n = x_in_cam.head<2>() * (1 / x_in_cam.z());
    if (!(x_in_cam.z() > 0 && n.squaredNorm() < end * end)) return std::nullopt;
    return distorted(k, n);
  }

  static std::optional<LensImage<kCount>> image(const LensCoefficients& k, double end,
                                                const Eigen::Vector3d& x_in_cam) {
    const double inverse_depth = 1 / x_in_cam.z();
    const Eigen::Vector2d n = x_in_cam.head<2>() * inverse_depth;
    const double r2 = n.squaredNorm();
    if (!(x_in_cam.z() > 0 && r2 < end * end)) return std::nullopt;
    Eigen::Matrix<double, 2, 3> d_n;
    d_n << inverse_depth, 0, -n.x() * inverse_depth, 0, inverse_depth, -n.y() * inverse_depth;
    LensImage<kCount> image;
    image.position = distorted(k, n);
    image.d_point = slope(k, n) * d_n;
    double share = 1;  // of the numerator in the factor
    if constexpr (kCount == 8) share = 1 / denominator(k, r2);
    const double xy2 = 2 * n.x() * n.y();
    image.d_coefficients.template leftCols<4>() << n.x() * r2 * share, n.x() * r2 * r2 * share, xy2,
        r2 + 2 * n.x() * n.x(),  //
        n.y() * r2 * share, n.y() * r2 * r2 * share, r2 + 2 * n.y() * n.y(), xy2;
    if constexpr (kCount > 4) image.d_coefficients.col(4) = (r2 * r2 * r2 * share) * n;
    if constexpr (kCount == 8) {
      const Eigen::Vector2d by_denominator = (-factor_of(k, r2) * share * r2) * n;
      image.d_coefficients.template rightCols<3>() << by_denominator, by_denominator * r2,
          by_denominator * (r2 * r2);
    }
    return image;
  }

  /// Newton's method from the radial solution; steps are halved until the residual falls, which
  /// the positive definite slope makes sure of.
  static std::optional<Eigen::Vector3d> bearing(const LensCoefficients& k, double end,
                                                const Eigen::Vector2d& position) {
    const auto n = undistorted(k, end, position);
    if (!n) return std::nullopt;
    return n->homogeneous().normalized();
  }

 private:
  static double denominator(const LensCoefficients& k, double r2) {
    return 1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  }

  static double factor_of(const LensCoefficients& k, double r2) {
    if constexpr (kCount == 4) {
      return 1 + r2 * (k[0] + r2 * k[1]);
    } else {
      const double numerator = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
      return kCount == 5 ? numerator : numerator / denominator(k, r2);
    }
  }

  /// Twice d factor / d r².
  static double slope_of_factor(const LensCoefficients& k, double r2) {
    if constexpr (kCount == 4) {
      return 2 * (k[0] + 2 * k[1] * r2);
    } else {
      const double numerator = 2 * (k[0] + r2 * (2 * k[1] + r2 * 3 * k[4]));
      if constexpr (kCount == 5) return numerator;
      const double of_denominator = 2 * (k[5] + r2 * (2 * k[6] + r2 * 3 * k[7]));
      return (numerator - factor_of(k, r2) * of_denominator) / denominator(k, r2);
    }
  }

  /// Distorted radius and its slope, without the tangential terms.
  static std::pair<double, double> radial(const LensCoefficients& k, double r) {
    const double r2 = r * r;
    const double factor = factor_of(k, r2);
    if constexpr (kCount == 4) return {r * factor, 1 + r2 * (3 * k[0] + r2 * 5 * k[1])};
    return {r * factor, factor + r2 * slope_of_factor(k, r2)};
  }

  static Eigen::Vector2d distorted(const LensCoefficients& k, const Eigen::Vector2d& n) {
    const double r2 = n.squaredNorm();
    const double xy2 = 2 * n.x() * n.y();
    return factor_of(k, r2) * n + Eigen::Vector2d(k[2] * xy2 + k[3] * (r2 + 2 * n.x() * n.x()),
                                                  k[2] * (r2 + 2 * n.y() * n.y()) + k[3] * xy2);
  }

  /// d distorted / d n. Symmetric: the distortion is the gradient of a potential.
  static Eigen::Matrix2d slope(const LensCoefficients& k, const Eigen::Vector2d& n) {
    const double x = n.x();
    const double y = n.y();
    const double r2 = n.squaredNorm();
    const double factor = factor_of(k, r2);
    const double d_factor = slope_of_factor(k, r2);
    const double mixed = d_factor * x * y + 2 * (k[2] * x + k[3] * y);
    Eigen::Matrix2d j;
    j << factor + d_factor * x * x + 2 * k[2] * y + 6 * k[3] * x, mixed, mixed,
        factor + d_factor * y * y + 6 * k[2] * y + 2 * k[3] * x;
    return j;
  }

  static std::optional<Eigen::Vector2d> undistorted(const LensCoefficients& k, double end,
                                                    const Eigen::Vector2d& position) {
    const double distance = position.norm();
    if (distance == 0) return Eigen::Vector2d(0, 0);
    const double start =
        invert_increasing([&](double r) { return radial(k, r); }, distance, end).value_or(end);
    Eigen::Vector2d n = position * (std::min(start, end * (1 - 1e-6)) / distance);
    Eigen::Vector2d residual = distorted(k, n) - position;
    for (int i = 0; i < 50; ++i) {
      Eigen::Vector2d step = slope(k, n).ldlt().solve(-residual);
      if (step.norm() <= 1e-15 * (1 + n.norm())) break;
      int halvings = 0;
      for (; halvings < 30; ++halvings, step *= 0.5) {
        const Eigen::Vector2d next = n + step;
        if (next.norm() >= end) continue;
        const Eigen::Vector2d next_residual = distorted(k, next) - position;
        if (next_residual.norm() >= residual.norm()) continue;
        n = next;
        residual = next_residual;
        break;
      }
      if (halvings == 30) break;
    }
    if (residual.norm() > 1e-12 * (1 + distance)) return std::nullopt;
    return n;
  }
};

}  // namespace waymark
