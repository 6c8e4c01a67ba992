#include "mapbuilder/diagnosis/square_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/median.h"
#include "core/estimate/corner_residual.h"
#include "core/estimate/ippe.h"
#include "core/estimate/pose_minimizer.h"

namespace waymark {
namespace {

/// Any size: poses of squares scale with it.
constexpr double kSize_m = 1.0;

}  // namespace

std::optional<SquareEquations> linearize_square(const CameraModel& camera,
                                                const ImageCorners& outline_px,
                                                const Rigid3& cam_from_marker) {
  SquareEquations all;
  const CornerChain chain(camera, Rigid3{}, Rigid3{}, cam_from_marker);
  const auto corners = marker_corners(kSize_m);
  for (std::size_t i = 0; i < 4; ++i) {
    CornerJacobians pose;
    CalibrationJacobians lens;
    const auto residual = corner_residual(chain, corners[i], outline_px[i], &pose, &lens);
    if (!residual) return std::nullopt;
    const auto row = static_cast<Eigen::Index>(2 * i);
    all.residual.segment<2>(row) = *residual;
    all.by_pose.middleRows<2>(row) = pose.d_marker;
    all.by_lens.middleRows<2>(row) = lens.d_intrinsics;
    // A corner of a stretched print moves in the marker's plane as the marker's centre would.
    const Eigen::Vector3d stretched(0.5 * corners[i].x(), -0.5 * corners[i].y(), 0);
    all.by_stretch.segment<2>(row) =
        pose.d_marker.leftCols<3>() * (cam_from_marker.rotation * stretched);
  }
  return all;
}

std::optional<Rigid3> own_pose(const CameraModel& camera, const ImageCorners& outline_px) {
  const auto solutions = solve_ippe(camera, outline_px, kSize_m);
  if (!solutions) return std::nullopt;
  constexpr int kIterations = 20;
  const auto optimum =
      minimize_pose(solutions->cam_from_marker[0], kIterations, [&](const Rigid3& pose) {
        PoseEquations equations;
        const auto all = linearize_square(camera, outline_px, pose);
        if (!all) return equations;
        equations.hessian = all->by_pose.transpose() * all->by_pose;
        equations.gradient = all->by_pose.transpose() * all->residual;
        equations.cost = all->residual.squaredNorm();
        equations.corners = 4;
        return equations;
      });
  if (!optimum) return std::nullopt;
  return optimum->pose;
}

std::optional<double> own_misfit_px2(const CameraModel& camera, const ImageCorners& outline_px) {
  const auto pose = own_pose(camera, outline_px);
  const auto one = pose ? linearize_square(camera, outline_px, *pose) : std::nullopt;
  if (!one) return std::nullopt;
  return one->residual.squaredNorm();
}

double own_px_of(std::vector<double> squared) {
  if (squared.empty()) return std::numeric_limits<double>::infinity();
  return std::sqrt(upper_median(squared) / kMedianOfChi2_2);
}

std::vector<ImageCorners> outlines_of(const DetectedCapture& capture, std::size_t camera) {
  const CameraModel& model = capture.rig.cameras[camera].model;
  std::vector<ImageCorners> outlines;
  for (const ImageDetections& image : capture.images) {
    if (image.camera != static_cast<int>(camera)) continue;
    for (const Detection& detection : image.detections) {
      if (model.covers_all(detection.corners)) outlines.push_back(detection.corners);
    }
  }
  return outlines;
}

std::vector<ImageCorners> spread(std::span<const ImageCorners> outlines, std::size_t most) {
  std::vector<ImageCorners> kept;
  const std::size_t count = std::min(most, outlines.size());
  for (std::size_t i = 0; i < count; ++i) kept.push_back(outlines[i * outlines.size() / count]);
  return kept;
}

}  // namespace waymark
