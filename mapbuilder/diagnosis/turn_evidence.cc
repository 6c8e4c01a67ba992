#include "mapbuilder/diagnosis/turn_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/estimate/pose_minimizer.h"

namespace waymark {
namespace {

/// Σ of squared residuals (px²).
double misfit_px2(const std::vector<TurnEvidence::Sight>& sights, const Rigid3& world_from_marker) {
  double px2 = 0;
  for (const TurnEvidence::Sight& sight : sights) {
    const ObservationGeometry& at = sight.geometry;
    px2 += squared_residual(sight.observation, *at.camera,
                            at.cam_from_rig * (at.world_from_rig.inverse() * world_from_marker));
  }
  return px2;
}

std::optional<Rigid3> optimum_near(std::vector<TurnEvidence::Sight> sights, const Rigid3& start) {
  constexpr int kIterations = 30;
  const auto optimum = minimize_pose(start, kIterations, [&](const Rigid3& world_from_marker) {
    PoseEquations equations;
    for (TurnEvidence::Sight& sight : sights) {
      sight.geometry.world_from_marker = world_from_marker;
      add_observation(sight.observation, sight.geometry,
                      ObservationLoss{Loss::squared, kInlierSigmas}, FreePose::marker, equations);
    }
    return equations;
  });
  if (!optimum) return std::nullopt;
  return optimum->pose;
}

}  // namespace

std::vector<TurnEvidence::Sight> TurnEvidence::sights_of(MarkerIndex marker) const {
  std::vector<Sight> sights;
  for (std::size_t i = 0; i < observations_.usable; ++i) {
    const ObservationIndex index(i);
    const Observation& o = observations_[index];
    if (o.marker != marker || !estimate_.accepts(index) || !estimate_.posed(o)) continue;
    const RigCamera& camera = estimate_.calibration.camera(observations_, o);
    Sight sight;
    sight.observation.size_m = estimate_.calibration.sizes_m[marker];
    sight.observation.corners_px = corrected_corners(o, estimate_.calibration);
    sight.observation.whitening.fill(Eigen::Matrix2d::Identity());
    sight.geometry = {&camera.model, camera.rig_from_cam.inverse(),
                      estimate_.world_from_rig[o.frame_set]->best.pose, Rigid3{}};
    sights.push_back(sight);
  }
  return sights;
}

bool TurnEvidence::contradicts(MarkerId marker, const Eigen::Quaterniond& turn) const {
  constexpr double kTells = 25.0;
  constexpr double kFreedoms = 6.0;
  const auto& markers = observations_.markers;
  const auto found = std::find(markers.begin(), markers.end(), marker);
  if (found == markers.end()) return false;
  const MarkerIndex index(static_cast<std::size_t>(found - markers.begin()));
  const auto& own = estimate_.world_from_marker[index];
  const std::vector<Sight> sights = sights_of(index);
  if (!own || sights.empty()) return false;
  const Eigen::Quaterniond turned = own->rotation * turn;
  const auto best = optimum_near(sights, {turned, own->translation});
  // No optimum of its own there: nothing leads to one, or it has gone back.
  if (!best || angle_between_rad(best->rotation, turned) >
                   angle_between_rad(best->rotation, own->rotation)) {
    return true;
  }
  const double own_px2 = std::max(std::numeric_limits<double>::min(), misfit_px2(sights, *own));
  const double freedoms = 8.0 * static_cast<double>(sights.size()) - kFreedoms;
  return freedoms * std::log(misfit_px2(sights, *best) / own_px2) > kTells;
}

}  // namespace waymark
