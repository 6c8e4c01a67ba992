#include "mapbuilder/diagnosis/print_shape.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>

#include "core/geometry/square_homography.h"
#include "mapbuilder/diagnosis/mono_build.h"

namespace waymark {
namespace {

constexpr std::size_t kImages = 40;
/// Printers scale by some percent; what is narrower is bent, or another thing.
constexpr double kMost = 0.08;

/// Squared misfit (px²) of a map of every image on its own, and what made it.
struct Trial {
  double stretch = 0;
  double squared_px2 = std::numeric_limits<double>::infinity();
  FitQuality quality;
  std::size_t numbers = 0;  ///< measured
};

Trial trial_of(const std::vector<DetectedCapture>& captures, double stretch,
               const BuildOptions& options) {
  Progress silent(false);
  Trial trial;
  trial.stretch = stretch;
  const auto build = build_mono(with_square_prints(captures, stretch), options, silent);
  if (!build || !std::isfinite(build->quality.joint_px)) return trial;
  trial.quality = build->quality;
  trial.squared_px2 = build->quality.joint_px * build->quality.joint_px;
  trial.numbers = 8 * build->observations.usable;
  return trial;
}

/// Where the parabola through three trials, `step` apart, is least; nullopt where it has no bottom.
struct Bottom {
  double at = 0;
  double curvature = 0;  ///< px² per squared stretch
};
std::optional<Bottom> bottom_of(const Trial& low, const Trial& middle, const Trial& high,
                                double step) {
  const double curvature =
      (low.squared_px2 - 2 * middle.squared_px2 + high.squared_px2) / (2 * step * step);
  if (!(curvature > 0) || !std::isfinite(curvature)) return std::nullopt;
  const double slope = (high.squared_px2 - low.squared_px2) / (2 * step);
  return Bottom{middle.stretch - slope / (2 * curvature), curvature};
}

}  // namespace

ImageCorners as_square(const ImageCorners& corners_px, double stretch) {
  const auto image_from_unit = homography_from_unit_square(corners_px);
  if (!image_from_unit) return corners_px;
  // The print's outline is the unit square; that of a square print is narrower by half the stretch
  // and higher by the other half.
  const double half_width = 0.5 * std::exp(-0.5 * stretch);
  const double half_height = 0.5 * std::exp(0.5 * stretch);
  constexpr std::array<std::array<double, 2>, 4> kSides{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  ImageCorners square;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d at(0.5 + kSides[i][0] * half_width, 0.5 + kSides[i][1] * half_height, 1);
    square[i] = (*image_from_unit * at).hnormalized();
  }
  return square;
}

std::vector<DetectedCapture> with_square_prints(std::vector<DetectedCapture> captures,
                                                double stretch) {
  for (DetectedCapture& capture : captures) {
    for (ImageDetections& image : capture.images) {
      for (Detection& detection : image.detections) {
        detection.corners = as_square(detection.corners, stretch);
      }
    }
  }
  return captures;
}

std::optional<PrintShape> fit_print_shape(const std::vector<DetectedCapture>& captures,
                                          const BuildOptions& options) {
  const std::vector<DetectedCapture> few = thinned(captures, kImages);
  // Misfits grow with the square of what is left of a stretch: a parabola, first over the whole
  // range, then near its bottom.
  Trial middle = trial_of(few, 0, options);
  const double squares_px2 = middle.squared_px2;
  std::optional<Bottom> bottom;
  for (const double step : {0.5 * kMost, 0.125 * kMost}) {
    const Trial low = trial_of(few, middle.stretch - step, options);
    const Trial high = trial_of(few, middle.stretch + step, options);
    bottom = bottom_of(low, middle, high, step);
    if (!bottom || std::abs(bottom->at) > kMost) return std::nullopt;
    middle = trial_of(few, bottom->at, options);
  }
  if (middle.squared_px2 >= squares_px2) return std::nullopt;
  PrintShape shape;
  shape.stretch = middle.stretch;
  shape.sigma =
      std::sqrt(middle.squared_px2 / (bottom->curvature * static_cast<double>(middle.numbers)));
  shape.quality = middle.quality;
  return shape;
}

Finding finding_of(const PrintShape& shape, const FitQuality& squares) {
  const double narrower = 100.0 * std::expm1(-std::abs(shape.stretch));
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::print_not_square;
  finding.subject = "markers";
  finding.text = fmt::format(
      "they are {:.1f} ± {:.1f} % {} in every view: printed not square (each image alone: {:.2f} "
      "px as squares, {:.2f} px so).",
      -narrower, std::max(0.1, 100.0 * shape.sigma),
      shape.stretch < 0 ? "narrower than high" : "lower than wide", squares.joint_px,
      shape.quality.joint_px);
  finding.remedy = "Measure both edges of a marker; print without scaling (\"actual size\").";
  finding.figures = {
      {"wider than high", 100.0 * std::expm1(shape.stretch), "%", 100.0 * shape.sigma}};
  return finding;
}

}  // namespace waymark
