#include "mapbuilder/diagnosis/turn_evidence.h"

#include <algorithm>
#include <cmath>

#include "core/estimate/marker_observation.h"
#include "core/estimate/pose_minimizer.h"

namespace waymark {

std::optional<TurnEvidence::Misfit> TurnEvidence::misfit_near(MarkerIndex marker,
                                                              const Rigid3& start) const {
  constexpr int kIterations = 30;
  struct Sight {
    MarkerObservation observation;
    ObservationGeometry geometry;
  };
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
  const auto optimum = minimize_pose(start, kIterations, [&](const Rigid3& world_from_marker) {
    PoseEquations equations;
    for (Sight& sight : sights) {
      sight.geometry.world_from_marker = world_from_marker;
      add_observation(sight.observation, sight.geometry,
                      ObservationLoss{Loss::squared, kInlierSigmas}, FreePose::marker, equations);
    }
    return equations;
  });
  if (!optimum || sights.empty()) return std::nullopt;
  double px2 = 0;
  for (const Sight& sight : sights) {
    const ObservationGeometry& at = sight.geometry;
    px2 += squared_residual(sight.observation, *at.camera,
                            at.cam_from_rig * (at.world_from_rig.inverse() * optimum->pose));
  }
  return Misfit{px2, 8 * static_cast<int>(sights.size()), optimum->pose};
}

bool TurnEvidence::contradicts(MarkerId marker, const Eigen::Quaterniond& turn) const {
  constexpr double kTells = 25.0;
  constexpr int kFreedoms = 6;
  const auto& markers = observations_.markers;
  const auto found = std::find(markers.begin(), markers.end(), marker);
  if (found == markers.end()) return false;
  const MarkerIndex index(static_cast<std::size_t>(found - markers.begin()));
  const auto& own = estimate_.world_from_marker[index];
  if (!own) return false;
  const Eigen::Quaterniond turned = own->rotation * turn;
  const auto as_estimated = misfit_near(index, *own);
  const auto as_turned = misfit_near(index, {turned, own->translation});
  if (!as_estimated) return false;
  // No optimum of its own there: nothing leads to one, or it has gone back.
  if (!as_turned) return true;
  if (angle_between_rad(as_turned->best.rotation, turned) >
      angle_between_rad(as_turned->best.rotation, own->rotation)) {
    return true;
  }
  return (as_estimated->residuals - kFreedoms) *
             std::log(as_turned->px2 / std::max(1e-12, as_estimated->px2)) >
         kTells;
}

}  // namespace waymark
