#include "mapbuilder/diagnosis/print_shape.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>

#include "core/detect/marker_plane.h"
#include "core/estimate/robust_loss.h"
#include "core/geometry/square_homography.h"
#include "core/geometry/symmetric_factor.h"
#include "core/marker/marker_outline.h"
#include "mapbuilder/diagnosis/square_equations.h"

namespace waymark {
namespace {

constexpr std::size_t kOutlines = 300;
/// Printers scale by some percent; what is narrower is bent, or another thing.
constexpr double kMost = 0.08;
/// A stretch of fewer standard deviations is none.
constexpr double kSigmas = 5.0;

/// An outline with the camera that saw it.
struct Outline {
  const CameraModel* camera;
  ImageCorners corners_px;
};

std::vector<Outline> outlines_of(const std::vector<DetectedCapture>& captures) {
  std::vector<Outline> outlines;
  for (const DetectedCapture& capture : captures) {
    for (std::size_t k = 0; k < capture.rig.cameras.size(); ++k) {
      const auto seen = outlines_of(capture, k);
      for (const ImageCorners& one : spread(seen, kOutlines)) {
        outlines.push_back({&capture.rig.cameras[k].model, one});
      }
    }
  }
  return outlines;
}

/// What an outline says of the stretch when its own pose has had its say.
struct StretchEquation {
  Eigen::Matrix<double, 8, 1> residual;    ///< px
  Eigen::Matrix<double, 8, 1> by_stretch;  ///< px
};

std::vector<StretchEquation> equations_at(const std::vector<Outline>& outlines, double stretch) {
  std::vector<StretchEquation> all;
  for (const Outline& outline : outlines) {
    const ImageCorners square = as_square(*outline.camera, outline.corners_px, stretch);
    const auto pose = own_pose(*outline.camera, square);
    const auto one = pose ? linearize_square(*outline.camera, square, *pose) : std::nullopt;
    if (!one) continue;
    const Matrix6d hessian = one->by_pose.transpose() * one->by_pose;
    const Vector6d by_pose =
        SymmetricFactor<6>(hessian).solve(one->by_pose.transpose() * one->by_stretch);
    all.push_back({one->residual, one->by_stretch - one->by_pose * by_pose});
  }
  return all;
}

double left_px(const std::vector<StretchEquation>& equations) {
  std::vector<double> squared;
  for (const StretchEquation& one : equations) squared.push_back(one.residual.squaredNorm());
  return own_px_of(std::move(squared));
}

/// A robust step of the stretch (Tukey's biweight at six times what corners are worth).
PrintShape improved(const std::vector<StretchEquation>& equations, double stretch) {
  constexpr double kScale = 6.0;
  PrintShape shape;
  shape.own_px = left_px(equations);
  const double variance = std::max(1e-6, shape.own_px * shape.own_px);
  double hessian = 0;
  double gradient = 0;
  for (const StretchEquation& one : equations) {
    const double weight =
        robust_weight(Loss::tukey, kScale, one.residual.squaredNorm() / variance) / variance;
    hessian += weight * one.by_stretch.squaredNorm();
    gradient += weight * one.by_stretch.dot(one.residual);
  }
  shape.stretch = hessian > 0 ? stretch - gradient / hessian : stretch;
  shape.sigma = hessian > 0 ? 1.0 / std::sqrt(hessian) : std::numeric_limits<double>::infinity();
  return shape;
}

}  // namespace

ImageCorners as_square(const CameraModel& camera, const ImageCorners& corners_px, double stretch) {
  const auto axis = camera.bearing(centre_of(corners_px));
  if (!axis) return corners_px;
  const MarkerPlane plane(camera, *axis);
  ImageCorners outline;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto point = plane.plane_from_pixel(corners_px[i]);
    if (!point) return corners_px;
    outline[i] = *point;
  }
  const auto plane_from_unit = homography_from_unit_square(outline);
  if (!plane_from_unit) return corners_px;
  // The print's outline is the unit square; that of a square print is narrower by half the stretch
  // and higher by the other half.
  const double half_width = 0.5 * std::exp(-0.5 * stretch);
  const double half_height = 0.5 * std::exp(0.5 * stretch);
  constexpr std::array<std::array<double, 2>, 4> kSides{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  ImageCorners square;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d at(0.5 + kSides[i][0] * half_width, 0.5 + kSides[i][1] * half_height, 1);
    const auto pixel = plane.pixel_from_plane((*plane_from_unit * at).hnormalized());
    if (!pixel) return corners_px;
    square[i] = *pixel;
  }
  return square;
}

std::vector<DetectedCapture> with_square_prints(std::vector<DetectedCapture> captures,
                                                double stretch) {
  for (DetectedCapture& capture : captures) {
    for (ImageDetections& image : capture.images) {
      const CameraModel& camera = capture.rig.cameras[static_cast<std::size_t>(image.camera)].model;
      for (Detection& detection : image.detections) {
        detection.corners = as_square(camera, detection.corners, stretch);
      }
    }
  }
  return captures;
}

std::optional<PrintShape> fit_print_shape(const std::vector<DetectedCapture>& captures) {
  const std::vector<Outline> outlines = outlines_of(captures);
  constexpr int kSteps = 3;
  PrintShape shape;
  for (int step = 0; step < kSteps; ++step) {
    const auto equations = equations_at(outlines, shape.stretch);
    if (equations.empty()) return std::nullopt;
    shape = improved(equations, shape.stretch);
    if (!(std::abs(shape.stretch) <= kMost && std::abs(shape.stretch) > kSigmas * shape.sigma)) {
      return std::nullopt;
    }
  }
  return shape;
}

Finding finding_of(const PrintShape& shape, const FitQuality& stretched, double squares_px) {
  const double narrower = 100.0 * std::expm1(-std::abs(shape.stretch));
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::print_not_square;
  finding.subject = "markers";
  finding.text = fmt::format(
      "they are {:.1f} ± {:.1f} % {} in every view: printed not square (each marker alone: {:.2f} "
      "px as a square, {:.2f} px so; all together {:.2f} px so).",
      -narrower, std::max(0.1, 100.0 * shape.sigma),
      shape.stretch < 0 ? "narrower than high" : "lower than wide", squares_px, shape.own_px,
      stretched.joint_px);
  finding.remedy = "Measure both edges of a marker; print without scaling (\"actual size\").";
  finding.figures = {
      {"wider than high", 100.0 * std::expm1(shape.stretch), "%", 100.0 * shape.sigma}};
  return finding;
}

}  // namespace waymark
