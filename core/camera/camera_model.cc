#include "core/camera/camera_model.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/range.h"

namespace waymark {
namespace {

using Matrix23d = Eigen::Matrix<double, 2, 3>;
using Matrix24d = Eigen::Matrix<double, 2, 4>;

/// From images of a few pixels to the longest telescopes; the principal point may lie beside an
/// image that was cropped.
constexpr Range kFocal_px{1, 1e7};
constexpr Range kPrincipal_px{-1e6, 1e6};
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Largest angle from the axis (rad) of the pinhole models; beyond, pixels mean nothing.
constexpr double kMaxPinholeAngle = 0.5 * std::numbers::pi - 1e-6;

/// A point on the plane of unit focal length, after distortion, with its derivatives.
struct ImagePoint {
  Eigen::Vector2d position;
  Matrix23d d_point;
  Matrix24d d_coefficients;
};

/// First x in (0, end] where `f` is not positive, or `end`. Sampled every milliradian: the
/// polynomials of lenses have no narrower dips.
template <typename Function>
double end_of_positive(const Function& f, double end) {
  constexpr double kStep = 1e-3;
  double below = 0;
  while (below < end) {
    double above = std::min(below + kStep, end);
    if (f(above) > 0) {
      below = above;
      continue;
    }
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (below + above);
      (f(middle) > 0 ? below : above) = middle;
    }
    return below;
  }
  return end;
}

/// x in [0, end] with f(x) = target, for `f` (value and slope) that grows from 0 on; nullopt
/// where f(end) < target. Newton's method, bisecting where a step would leave the bracket.
template <typename Function>
std::optional<double> invert_increasing(const Function& f, double target, double end) {
  double lower = 0;
  double upper = std::min(end, std::max(1.0, target));
  while (f(upper).first < target) {
    if (upper >= end) return std::nullopt;
    lower = upper;
    upper = std::min(2 * upper, end);
  }
  double x = std::clamp(target, lower, upper);
  for (int i = 0; i < 100; ++i) {
    const auto [value, slope] = f(x);
    (value < target ? lower : upper) = x;
    double next = x + (target - value) / slope;
    if (!(next >= lower && next <= upper)) next = 0.5 * (lower + upper);
    const bool arrived = std::abs(next - x) <= 1e-15 * (1 + x);
    x = next;
    if (arrived) break;
  }
  return x;
}

// --- radtan: OpenCV's k1 k2 p1 p2 on n = (x/z, y/z) ---

double radial_factor(const std::array<double, 4>& k, double r2) {
  return 1 + r2 * (k[0] + r2 * k[1]);
}

/// Distorted radius and its slope, without the tangential terms.
std::pair<double, double> radial(const std::array<double, 4>& k, double r) {
  const double r2 = r * r;
  return {r * radial_factor(k, r2), 1 + r2 * (3 * k[0] + r2 * 5 * k[1])};
}

Eigen::Vector2d distort_radtan(const std::array<double, 4>& k, const Eigen::Vector2d& n) {
  const double r2 = n.squaredNorm();
  const double xy2 = 2 * n.x() * n.y();
  return radial_factor(k, r2) * n + Eigen::Vector2d(k[2] * xy2 + k[3] * (r2 + 2 * n.x() * n.x()),
                                                    k[2] * (r2 + 2 * n.y() * n.y()) + k[3] * xy2);
}

/// d distorted / d n. Symmetric: the distortion is the gradient of a potential.
Eigen::Matrix2d radtan_slope(const std::array<double, 4>& k, const Eigen::Vector2d& n) {
  const double x = n.x();
  const double y = n.y();
  const double r2 = n.squaredNorm();
  const double factor = radial_factor(k, r2);
  const double d_factor = 2 * (k[0] + 2 * k[1] * r2);  // d factor / d r², twice
  const double mixed = d_factor * x * y + 2 * (k[2] * x + k[3] * y);
  Eigen::Matrix2d j;
  j << factor + d_factor * x * x + 2 * k[2] * y + 6 * k[3] * x, mixed, mixed,
      factor + d_factor * y * y + 6 * k[2] * y + 2 * k[3] * x;
  return j;
}

/// Where the distortion is one-to-one: the largest disc on which its (symmetric) slope is positive
/// definite, for then it is the gradient of a convex potential. The slope's eigenvalues are those
/// of the radial part, 1 + 3k₁r² + 5k₂r⁴ and 1 + k₁r² + k₂r⁴, less at most 6|(p₁, p₂)|r.
double max_radtan_radius(const std::array<double, 4>& k) {
  const double tangential = 6 * std::hypot(k[2], k[3]);
  const auto least_slope = [&](double angle) {
    const double r = std::tan(angle);
    return std::min(radial(k, r).second, radial_factor(k, r * r)) - tangential * r;
  };
  return std::tan(end_of_positive(least_slope, kMaxPinholeAngle));
}

/// Newton's method from the radial solution; steps are halved until the residual falls, which the
/// positive definite slope makes sure of.
std::optional<Eigen::Vector2d> undistort_radtan(const std::array<double, 4>& k, double max_radius,
                                                const Eigen::Vector2d& distorted) {
  const double distance = distorted.norm();
  if (distance == 0) return Eigen::Vector2d(0, 0);
  const double start =
      invert_increasing([&](double r) { return radial(k, r); }, distance, max_radius)
          .value_or(max_radius);
  Eigen::Vector2d n = distorted * (std::min(start, max_radius * (1 - 1e-6)) / distance);
  Eigen::Vector2d residual = distort_radtan(k, n) - distorted;
  for (int i = 0; i < 50; ++i) {
    Eigen::Vector2d step = radtan_slope(k, n).ldlt().solve(-residual);
    if (step.norm() <= 1e-15 * (1 + n.norm())) break;
    int halvings = 0;
    for (; halvings < 30; ++halvings, step *= 0.5) {
      const Eigen::Vector2d next = n + step;
      if (next.norm() >= max_radius) continue;
      const Eigen::Vector2d next_residual = distort_radtan(k, next) - distorted;
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

std::optional<ImagePoint> image_radtan(const std::array<double, 4>& k, double max_radius,
                                       const Eigen::Vector3d& x_in_cam) {
  const double inverse_depth = 1 / x_in_cam.z();
  const Eigen::Vector2d n = x_in_cam.head<2>() * inverse_depth;
  const double r2 = n.squaredNorm();
  if (!(x_in_cam.z() > 0 && r2 < max_radius * max_radius)) return std::nullopt;
  Matrix23d d_n;
  d_n << inverse_depth, 0, -n.x() * inverse_depth, 0, inverse_depth, -n.y() * inverse_depth;
  ImagePoint image;
  image.position = distort_radtan(k, n);
  image.d_point = radtan_slope(k, n) * d_n;
  const double xy2 = 2 * n.x() * n.y();
  image.d_coefficients << n.x() * r2, n.x() * r2 * r2, xy2, r2 + 2 * n.x() * n.x(),  //
      n.y() * r2, n.y() * r2 * r2, r2 + 2 * n.y() * n.y(), xy2;
  return image;
}

// --- equidistant: Kannala and Brandt's θd = θ(1 + k1θ² + k2θ⁴ + k3θ⁶ + k4θ⁸) ---

/// Distorted angle and its slope.
std::pair<double, double> distorted_angle(const std::array<double, 4>& k, double theta) {
  const double t2 = theta * theta;
  const double value = theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  const double slope = 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
  return {value, slope};
}

double max_equidistant_angle(const std::array<double, 4>& k) {
  return end_of_positive([&](double theta) { return distorted_angle(k, theta).second; },
                         std::numbers::pi);
}

std::optional<ImagePoint> image_equidistant(const std::array<double, 4>& k, double max_theta,
                                            const Eigen::Vector3d& x_in_cam) {
  const Eigen::Vector2d side = x_in_cam.head<2>();
  const double z = x_in_cam.z();
  const double rho = side.norm();
  const double n2 = rho * rho + z * z;
  const double theta = std::atan2(rho, z);
  if (!(n2 > 0 && n2 < kInfinity && theta < max_theta)) return std::nullopt;
  const auto [angle, slope] = distorted_angle(k, theta);
  // position = side · scale with scale = θd/ρ; d scale / d side = side · curl.
  const bool on_axis = rho < 1e-9 * z;
  const double scale = on_axis ? 1 / z : angle / rho;
  const double curl =
      on_axis ? (2 * k[0] - 2.0 / 3.0) / (z * z * z) : (slope * z / n2 - scale) / (rho * rho);
  ImagePoint image;
  image.position = scale * side;
  image.d_point.leftCols<2>() =
      scale * Eigen::Matrix2d::Identity() + curl * side * side.transpose();
  image.d_point.col(2) = -slope / n2 * side;
  const double t2 = theta * theta;
  const Eigen::Vector2d cubic = (on_axis ? t2 / z : theta * t2 / rho) * side;
  image.d_coefficients << cubic, cubic * t2, cubic * (t2 * t2), cubic * (t2 * t2 * t2);
  return image;
}

bool all_finite(const CameraParameters& p) {
  return std::isfinite(p.fu_px) && std::isfinite(p.fv_px) && std::isfinite(p.pu_px) &&
         std::isfinite(p.pv_px) &&
         std::all_of(p.coefficients.begin(), p.coefficients.end(),
                     [](double c) { return std::isfinite(c); });
}

/// Where the image ends: its corners, or for fisheyes, whose round image may leave them black, the
/// middles of its edges.
std::array<Eigen::Vector2d, 4> image_limits(const CameraParameters& p) {
  const double right = p.width_px - 0.5;
  const double bottom = p.height_px - 0.5;
  if (p.distortion != Distortion::equidistant) {
    return {{{-0.5, -0.5}, {right, -0.5}, {right, bottom}, {-0.5, bottom}}};
  }
  const double middle_x = 0.5 * (right - 0.5);
  const double middle_y = 0.5 * (bottom - 0.5);
  return {{{middle_x, -0.5}, {right, middle_y}, {middle_x, bottom}, {-0.5, middle_y}}};
}

/// Pixel that a lens of the same focal length without distortion would give (equidistant: θd = θ).
Eigen::Vector2d ideal_pixel(const CameraParameters& p, const Eigen::Vector3d& bearing) {
  Eigen::Vector2d n = bearing.head<2>() / bearing.z();
  if (p.distortion == Distortion::equidistant) {
    n = bearing.head<2>().normalized() * std::atan2(bearing.head<2>().norm(), bearing.z());
  }
  return {p.fu_px * n.x() + p.pu_px, p.fv_px * n.y() + p.pv_px};
}

}  // namespace

std::string_view to_string(Distortion distortion) {
  switch (distortion) {
    case Distortion::none:
      return "none";
    case Distortion::radtan:
      return "radtan";
    case Distortion::equidistant:
      return "equidistant";
  }
  return "unknown";
}

CameraModel::CameraModel(const CameraParameters& parameters)
    : parameters_(parameters), max_radius_(kInfinity), max_theta_(std::numbers::pi) {
  switch (parameters_.distortion) {
    case Distortion::none:
      parameters_.coefficients = {};
      break;
    case Distortion::radtan:
      max_radius_ = max_radtan_radius(parameters_.coefficients);
      break;
    case Distortion::equidistant:
      max_theta_ = max_equidistant_angle(parameters_.coefficients);
      break;
  }
}

Expected<CameraModel> CameraModel::create(const CameraParameters& p) {
  if (p.width_px <= 0 || p.height_px <= 0) {
    return fail(ErrorKind::bad_data, "camera resolution {}x{} px is not positive", p.width_px,
                p.height_px);
  }
  if (!all_finite(p)) {
    return fail(ErrorKind::bad_data, "camera intrinsics or distortion coefficients are not finite");
  }
  const Status in_range = RangeCheck()
                              .field("fu", p.fu_px, kFocal_px)
                              .field("fv", p.fv_px, kFocal_px)
                              .field("pu", p.pu_px, kPrincipal_px)
                              .field("pv", p.pv_px, kPrincipal_px)
                              .status();
  if (!in_range) {
    return fail(ErrorKind::bad_data, "camera focal lengths or principal point: {} px",
                in_range.error().message);
  }
  const CameraModel model(p);
  const double half_diagonal = 0.5 * std::hypot(p.width_px, p.height_px);
  for (const Eigen::Vector2d& limit : image_limits(p)) {
    const auto bearing = model.bearing(limit);
    if (!bearing || (ideal_pixel(p, *bearing) - limit).norm() >= half_diagonal) {
      return fail(
          ErrorKind::bad_data,
          "{} distortion can't be undone at the image's edge ({}, {}) px; the coefficients, "
          "focal lengths or resolution are another lens's",
          to_string(p.distortion), limit.x(), limit.y());
    }
  }
  return model;
}

std::optional<Eigen::Vector2d> CameraModel::project(const Eigen::Vector3d& x_in_cam) const {
  const CameraParameters& p = parameters_;
  Eigen::Vector2d m;
  if (p.distortion == Distortion::equidistant) {
    const auto image = image_equidistant(p.coefficients, max_theta_, x_in_cam);
    if (!image) return std::nullopt;
    m = image->position;
  } else {
    const Eigen::Vector2d n = x_in_cam.head<2>() * (1 / x_in_cam.z());
    if (!(x_in_cam.z() > 0 && n.squaredNorm() < max_radius_ * max_radius_)) return std::nullopt;
    m = distort_radtan(p.coefficients, n);
  }
  return Eigen::Vector2d(p.fu_px * m.x() + p.pu_px, p.fv_px * m.y() + p.pv_px);
}

std::optional<Projection> CameraModel::project_with_jacobian(
    const Eigen::Vector3d& x_in_cam, IntrinsicsJacobian* d_intrinsics) const {
  const CameraParameters& p = parameters_;
  const auto image = p.distortion == Distortion::equidistant
                         ? image_equidistant(p.coefficients, max_theta_, x_in_cam)
                         : image_radtan(p.coefficients, max_radius_, x_in_cam);
  if (!image) return std::nullopt;
  const Eigen::Vector2d focal(p.fu_px, p.fv_px);
  if (d_intrinsics != nullptr) {
    d_intrinsics->leftCols<4>() << image->position.x(), 0, 1, 0, 0, image->position.y(), 0, 1;
    if (p.distortion == Distortion::none) {
      d_intrinsics->rightCols<4>().setZero();
    } else {
      d_intrinsics->rightCols<4>() = focal.asDiagonal() * image->d_coefficients;
    }
  }
  return Projection{focal.cwiseProduct(image->position) + Eigen::Vector2d(p.pu_px, p.pv_px),
                    focal.asDiagonal() * image->d_point};
}

std::optional<Eigen::Vector3d> CameraModel::bearing(const Eigen::Vector2d& pixel) const {
  const CameraParameters& p = parameters_;
  if (!pixel.allFinite()) return std::nullopt;
  const Eigen::Vector2d m((pixel.x() - p.pu_px) / p.fu_px, (pixel.y() - p.pv_px) / p.fv_px);
  if (p.distortion == Distortion::equidistant) {
    const double distance = m.norm();
    const auto theta = invert_increasing(
        [&](double t) { return distorted_angle(p.coefficients, t); }, distance, max_theta_);
    if (!theta || *theta >= max_theta_) return std::nullopt;
    if (distance == 0) return Eigen::Vector3d(0, 0, 1);
    const Eigen::Vector2d side = m * (std::sin(*theta) / distance);
    return Eigen::Vector3d(side.x(), side.y(), std::cos(*theta));
  }
  if (p.distortion == Distortion::none) return m.homogeneous().normalized();
  const auto n = undistort_radtan(p.coefficients, max_radius_, m);
  if (!n) return std::nullopt;
  return n->homogeneous().normalized();
}

bool CameraModel::in_image(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.x() < parameters_.width_px - 0.5 && pixel.y() >= -0.5 &&
         pixel.y() < parameters_.height_px - 0.5;
}

}  // namespace waymark
