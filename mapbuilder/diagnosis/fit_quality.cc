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

}  // namespace

FitQuality fit_quality(const Selection& selection, const BuildResult& result) {
  const Observations& observations = selection.observations();
  std::vector<double> own;
  const auto used = selection.used();
  const std::size_t every = 1 + used.size() / (kMaxJudged + 1);
  for (std::size_t i = 0; i < used.size(); i += every) {
    const Observation& o = selection[used[i]];
    const CameraPlace& place = observations.cameras[o.camera];
    const auto squared = own_residual(observations.rigs[place.rig].cameras[place.in_rig], o,
                                      selection.stated_sizes_m()[o.marker]);
    if (squared) own.push_back(*squared);
  }
  std::vector<double> joint;
  for (const BuiltSubMap& submap : result.submaps) {
    for (const ObservationResidual& residual : submap.residuals) {
      joint.push_back(sum_of_squares(residual.corners_px));
    }
  }
  joint.resize(std::max(joint.size(), used.size()), std::numeric_limits<double>::infinity());
  return {sigma_of(std::move(own), kMedianOfChi2_2), sigma_of(std::move(joint), kMedianOfChi2_8)};
}

}  // namespace waymark
