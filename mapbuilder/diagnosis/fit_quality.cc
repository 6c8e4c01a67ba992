#include "mapbuilder/diagnosis/fit_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/median.h"

namespace waymark {
namespace {

/// Observations that the yardstick is taken of; of more, every n-th.
constexpr std::size_t kMaxJudged = 1000;

double sigma_of(std::vector<double> squared, double median_chi2) {
  if (squared.empty()) return std::numeric_limits<double>::infinity();
  return std::sqrt(upper_median(squared) / median_chi2);
}

double sum_of_squares(const std::array<Eigen::Vector2d, 4>& residuals) {
  double sum = 0;
  for (const Eigen::Vector2d& r : residuals) sum += r.squaredNorm();
  return sum;
}

/// Squared residual (px²) that the marker's best pose of its own leaves.
std::optional<double> own_residual(const RigCamera& camera, const Observation& o, double size_m) {
  MarkerObservation observation;
  observation.size_m = size_m;
  observation.corners_px = o.corners_px;
  observation.whitening.fill(Eigen::Matrix2d::Identity());
  const auto solutions = solve_ippe(camera.model, o.corners_px, size_m);
  if (!solutions) return std::nullopt;
  const auto optimum =
      minimize_pose(solutions->cam_from_marker[0], 20, [&](const Rigid3& cam_from_marker) {
        PoseEquations equations;
        add_observation(observation, {&camera.model, Rigid3{}, Rigid3{}, cam_from_marker},
                        ObservationLoss{Loss::squared, 6.0}, FreePose::marker, equations);
        return equations;
      });
  if (!optimum) return std::nullopt;
  const auto residuals = corner_residuals(observation, camera.model, optimum->pose);
  if (!residuals) return std::nullopt;
  return sum_of_squares(*residuals);
}

/// Squared residual (px²) by the estimate's poses; infinite where it has none.
double joint_residual(const Observations& observations, const Estimate& estimate,
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

}  // namespace

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
    const auto squared = own_residual(estimate.calibration.camera(observations, o), o,
                                      estimate.calibration.sizes_m[o.marker]);
    if (squared) own.push_back(*squared);
  }
  std::vector<double> joint;
  for (const ObservationIndex index : judged) {
    joint.push_back(joint_residual(observations, estimate, selection[index]));
  }
  return {sigma_of(std::move(own), kMedianOfChi2_2), sigma_of(std::move(joint), kMedianOfChi2_8)};
}

}  // namespace waymark
