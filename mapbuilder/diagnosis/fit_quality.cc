#include "mapbuilder/diagnosis/fit_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/median.h"
#include "mapbuilder/diagnosis/square_equations.h"

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
    const CameraModel& camera = estimate.calibration.camera(observations, o).model;
    if (const auto squared = own_misfit_px2(camera, o.corners_px)) own.push_back(*squared);
  }
  std::vector<double> joint;
  for (const ObservationIndex index : judged) {
    joint.push_back(joint_residual(observations, estimate, selection[index]));
  }
  return {sigma_of(std::move(own), kMedianOfChi2_2), sigma_of(std::move(joint), kMedianOfChi2_8)};
}

}  // namespace waymark
