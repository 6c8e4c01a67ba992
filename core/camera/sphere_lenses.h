#pragma once

#include <Eigen/Geometry>
#include <limits>

#include "core/camera/camera_model.h"
#include "core/camera/lens_image.h"

namespace waymark {

/// What a lens divides by in the place of a pinhole's depth z, with its derivatives.
template <int kCoefficients>
struct LensDepth {
  double value = 0;
  Eigen::RowVector3d d_point;
  Eigen::Matrix<double, 1, kCoefficients> d_coefficients;
  double cosine = 0;  ///< what the domain's end bounds from below
};

/// A lens that divides x and y by a depth of its own.
template <typename Depth>
struct DividingLens {
  static constexpr int kCoefficients = Depth::kCoefficients;

  static double domain_end(const LensCoefficients& k) { return Depth::domain_end(k); }

  static double image_end(const LensCoefficients& k, double /*end*/) { return Depth::image_end(k); }

  static std::optional<Eigen::Vector2d> position(const LensCoefficients& k, double end,
                                                 const Eigen::Vector3d& x_in_cam) {
    const auto depth = Depth::of(k, x_in_cam);
    if (!inside(depth, end)) return std::nullopt;
    return Eigen::Vector2d(x_in_cam.head<2>() * (1 / depth.value));
  }

  static std::optional<LensImage<kCoefficients>> image(const LensCoefficients& k, double end,
                                                       const Eigen::Vector3d& x_in_cam) {
    const auto depth = Depth::of(k, x_in_cam);
    if (!inside(depth, end)) return std::nullopt;
    LensImage<kCoefficients> image;
    const double share = 1 / depth.value;
    image.position = x_in_cam.head<2>() * share;
    image.d_point = -(image.position * share) * depth.d_point;
    image.d_point(0, 0) += share;
    image.d_point(1, 1) += share;
    image.d_coefficients = -(image.position * share) * depth.d_coefficients;
    return image;
  }

  static std::optional<Eigen::Vector3d> bearing(const LensCoefficients& k, double /*end*/,
                                                const Eigen::Vector2d& position) {
    const double end = Depth::image_end(k);
    if (!(position.squaredNorm() < end * end)) return std::nullopt;
    return Depth::bearing(k, position);
  }

 private:
  static bool inside(const LensDepth<kCoefficients>& depth, double end) {
    return depth.value > 0 && std::isfinite(depth.value) && depth.cosine > end;
  }
};

/// A pinhole: its depth is z.
struct StraightDepth {
  static constexpr int kCoefficients = 0;
  static double domain_end(const LensCoefficients& /*k*/) { return 0; }
  static double image_end(const LensCoefficients& /*k*/) {
    return std::numeric_limits<double>::infinity();
  }
  static LensDepth<0> of(const LensCoefficients& /*k*/, const Eigen::Vector3d& x) {
    return {x.z(), {0, 0, 1}, {}, std::isfinite(x.head<2>().squaredNorm()) ? x.z() : -1};
  }
  static Eigen::Vector3d bearing(const LensCoefficients& /*k*/, const Eigen::Vector2d& position) {
    return position.homogeneous().normalized();
  }
};

/// Both models below: beyond alpha = ½ the image ends where its radius stops growing, below it
/// where the depth becomes zero; at this cosine, negative, on the (last) sphere.
inline double end_on_sphere(double alpha) {
  return alpha > 0.5 ? -(1 - alpha) / alpha : -alpha / (1 - alpha);
}

/// Extended unified camera model (Khomutenko, Garcia, Martinet 2016, eqs. 2 and 6): alpha beta,
///   depth = alpha d + (1 − alpha) z,  d² = beta (x² + y²) + z².
struct ExtendedUnifiedDepth {
  static constexpr int kCoefficients = 2;
  static double domain_end(const LensCoefficients& k) { return end_on_sphere(k[0]); }
  static double image_end(const LensCoefficients& k) {
    if (!(k[0] > 0.5)) return std::numeric_limits<double>::infinity();
    return 1 / std::sqrt(k[1] * (2 * k[0] - 1));
  }
  static LensDepth<2> of(const LensCoefficients& k, const Eigen::Vector3d& x) {
    const double side2 = x.head<2>().squaredNorm();
    const double d = std::sqrt(k[1] * side2 + x.z() * x.z());
    const double by_side = k[0] * k[1] / d;
    return {k[0] * d + (1 - k[0]) * x.z(),
            {by_side * x.x(), by_side * x.y(), k[0] * x.z() / d + 1 - k[0]},
            {d - x.z(), 0.5 * k[0] * side2 / d},
            x.z() / d};
  }
  static Eigen::Vector3d bearing(const LensCoefficients& k, const Eigen::Vector2d& position) {
    const double r2 = k[1] * position.squaredNorm();
    const double root = std::sqrt(1 - (2 * k[0] - 1) * r2);
    const double z = (1 - k[0] * k[0] * r2) / (k[0] * root + 1 - k[0]);
    return Eigen::Vector3d(position.x(), position.y(), z).normalized();
  }
};

/// Double sphere (Usenko, Demmel, Cremers 2018, eqs. 40–52): xi alpha,
///   depth = alpha d₂ + (1 − alpha) s,  s = xi d₁ + z,  d₁² = x² + y² + z²,  d₂² = x² + y² + s².
struct DoubleSphereDepth {
  static constexpr int kCoefficients = 2;
  static double domain_end(const LensCoefficients& k) { return end_on_sphere(k[1]); }
  static double image_end(const LensCoefficients& k) {
    if (!(k[1] > 0.5)) return std::numeric_limits<double>::infinity();
    return 1 / std::sqrt(2 * k[1] - 1);
  }
  static LensDepth<2> of(const LensCoefficients& k, const Eigen::Vector3d& x) {
    const double side2 = x.head<2>().squaredNorm();
    const double d1 = std::sqrt(side2 + x.z() * x.z());
    const double s = k[0] * d1 + x.z();
    const double d2 = std::sqrt(side2 + s * s);
    const double by_s = k[1] * s / d2 + 1 - k[1];
    const Eigen::RowVector3d d_s(k[0] * x.x() / d1, k[0] * x.y() / d1, k[0] * x.z() / d1 + 1);
    return {k[1] * d2 + (1 - k[1]) * s,
            by_s * d_s + Eigen::RowVector3d(k[1] * x.x() / d2, k[1] * x.y() / d2, 0),
            {by_s * d1, d2 - s},
            s / d2};
  }
  static Eigen::Vector3d bearing(const LensCoefficients& k, const Eigen::Vector2d& position) {
    const double r2 = position.squaredNorm();
    const double root = std::sqrt(1 - (2 * k[1] - 1) * r2);
    const double z = (1 - k[1] * k[1] * r2) / (k[1] * root + 1 - k[1]);
    const double scale = (z * k[0] + std::sqrt(z * z + (1 - k[0] * k[0]) * r2)) / (z * z + r2);
    return Eigen::Vector3d(scale * position.x(), scale * position.y(), scale * z - k[0])
        .normalized();
  }
};

}  // namespace waymark
