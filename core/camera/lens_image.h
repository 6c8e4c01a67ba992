#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace waymark {

/// A point on the plane of unit focal length, after the lens, with its derivatives by the point in
/// the camera frame and by the lens's coefficients.
template <int kCoefficients>
struct LensImage {
  Eigen::Vector2d position;
  Eigen::Matrix<double, 2, 3> d_point;
  Eigen::Matrix<double, 2, kCoefficients> d_coefficients;
};

/// Largest angle from the axis (rad) of the pinhole models; beyond, pixels mean nothing.
inline constexpr double kMaxPinholeAngle = 0.5 * std::numbers::pi - 1e-6;

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

}  // namespace waymark
