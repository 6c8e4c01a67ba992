#include "mapbuilder/diagnosis/fit_quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/median.h"
#include "mapbuilder/diagnosis/square_equations.h"

namespace waymark {
namespace {

/// Observations that the yardstick is taken of; of more, every n-th.
constexpr std::size_t kMaxJudged = 1000;
/// Markers by which a camera is judged; of fewer, two that moved or are misread are half. (4–20)
constexpr std::size_t kTellsOfCamera = 6;

double sigma_of(std::vector<double> squared, double median_chi2) {
  if (squared.empty()) return std::numeric_limits<double>::infinity();
  return std::sqrt(upper_median(squared) / median_chi2);
}

double sum_of_squares(const std::array<Eigen::Vector2d, 4>& residuals) {
  double sum = 0;
  for (const Eigen::Vector2d& r : residuals) sum += r.squaredNorm();
  return sum;
}

/// Squared residuals (px²) of the observations by camera and marker.
using JointResiduals = std::map<CameraIndex, std::map<MarkerIndex, std::vector<double>>>;

/// The worst camera's (px), 0 where none sees enough markers.
double worst_of(JointResiduals joint) {
  double worst_px = 0;
  for (auto& [camera, by_marker] : joint) {
    if (by_marker.size() < kTellsOfCamera) continue;
    std::vector<double> medians;
    for (auto& [marker, squared] : by_marker) medians.push_back(upper_median(squared));
    worst_px = std::max(worst_px, sigma_of(std::move(medians), kMedianOfChi2_8));
  }
  return worst_px;
}

}  // namespace

double joint_residual_px2(const Observations& observations, const Estimate& estimate,
                          const Observation& o) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  if (!estimate.posed(o)) return kFar;
  MarkerObservation observation;
  observation.size_m = estimate.calibration.sizes_m[o.marker];
  observation.corners_px = corrected_corners(o, estimate.calibration);
  const auto residuals =
      corner_residuals(observation, estimate.calibration.camera(observations, o).model,
                       cam_from_marker(observations, estimate, o));
  return residuals ? sum_of_squares(*residuals) : kFar;
}

std::string worst_camera_text(const FitQuality& quality) {
  if (!std::isfinite(quality.worst_camera_px)) return "more than half of its markers";
  return fmt::format("{:.1f} px", quality.worst_camera_px);
}

bool is_poor(const FitQuality& mono) {
  constexpr double kWorse = 1.4;  // than corners are worth
  return mono.joint_px > kWorse * mono.own_px || mono.joint_px > kPoorFit_px;
}

FitQuality fit_quality(const Selection& selection, const Estimate& estimate,
                       std::optional<RigIndex> only) {
  const Observations& observations = selection.observations();
  std::vector<ObservationIndex> judged;
  for (const ObservationIndex index : selection.used()) {
    if (!only || observations.cameras[selection[index].camera].rig == *only) {
      judged.push_back(index);
    }
  }
  std::vector<double> own;
  const std::size_t every = 1 + judged.size() / (kMaxJudged + 1);
  for (std::size_t i = 0; i < judged.size(); i += every) {
    const Observation& o = selection[judged[i]];
    const CameraModel& camera = estimate.calibration.camera(observations, o).model;
    if (const auto squared = own_misfit_px2(camera, o.corners_px)) own.push_back(*squared);
  }
  std::vector<double> all;
  JointResiduals by_camera;
  for (const ObservationIndex index : judged) {
    const Observation& o = selection[index];
    all.push_back(joint_residual_px2(observations, estimate, o));
    by_camera[o.camera][o.marker].push_back(all.back());
  }
  FitQuality quality{sigma_of(std::move(own), kMedianOfChi2_2),
                     sigma_of(std::move(all), kMedianOfChi2_8), 0};
  quality.worst_camera_px = std::max(quality.joint_px, worst_of(std::move(by_camera)));
  return quality;
}

}  // namespace waymark
