#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "bench/locd_accuracy/measurements.h"
#include "bench/locd_accuracy/pose_errors.h"
#include "bench/simulated_drive.h"
#include "core/estimate/corner_residual.h"
#include "locd/pose/localizer.h"

namespace waymark::bench {
namespace {

/// Cramér–Rao bound of the pose by the last set's detections; nullopt when it has none.
std::optional<Matrix6d> bound_of(const SimulatedDrive& drive, const Rig& rig, const MarkerMap& map,
                                 const Rigid3& truth, double noise_px) {
  std::map<MarkerId, const MapMarker*> mapped;
  for (const MapMarker& marker : map.submaps.front().markers) mapped[marker.id] = &marker;
  Matrix6d information = Matrix6d::Zero();
  for (const ImageDetections& image : drive.images()) {
    const RigCamera& camera = rig.cameras[static_cast<std::size_t>(image.camera)];
    for (const Detection& detection : image.detections) {
      const MapMarker& marker = *mapped.at(detection.marker);
      const CornerChain chain(camera.model, camera.rig_from_cam.inverse(), truth,
                              marker.world_from_marker);
      const auto corners = marker_corners(marker.size_m);
      for (std::size_t i = 0; i < 4; ++i) {
        CornerJacobians jacobians;
        if (!corner_residual(chain, corners[i], detection.corners[i], &jacobians)) continue;
        information += jacobians.d_rig.transpose() * jacobians.d_rig / (noise_px * noise_px);
      }
    }
  }
  const Eigen::LDLT<Matrix6d> factor(information);
  if (!factor.isPositive() || factor.vectorD().minCoeff() <= 1e-6) return std::nullopt;
  return factor.solve(Matrix6d::Identity());
}

}  // namespace

/// (a) and (c): how near to the bound, how true the covariance, how many are OK.
void measure_bound(int sets) {
  fmt::print(
      "(a, c) true map, 0.1 px: RMS error over Cramér–Rao bound (bar 1.3), mean NEES of 6 "
      "in its 99 % interval, OK of sets whose bound is 3 sigma <= 10 mm and 0.25° (bar 99 %)\n");
  for (const std::string scene_name : {"room1", "room2", "corridor", "warehouse", "pool"}) {
    for (const std::string rig_name : {"cg120", "cg60"}) {
      const auto scene = scene_named(scene_name);
      const Rig rig = rig_named(rig_name);
      const MarkerMap map = true_map(scene);
      SimulatedDrive drive(scene, rig, {});
      Localizer localizer(rig, map, {});
      PoseEstimate estimate;
      Errors errors;
      Errors ok;
      double bound_position2 = 0, bound_rotation2 = 0;
      int firm = 0, firm_ok = 0;
      for (int i = 0; i < sets; ++i) {
        const FrameSetLease set = drive.next();
        localizer.localize(set, estimate);
        const Rigid3 truth = drive.world_from_rig(estimate.stamp);
        const auto bound = bound_of(drive, rig, map, truth, 0.1);
        if (!bound) continue;
        const PoseSigmas sigmas = worst_sigmas(*bound);
        const bool is_firm =
            3 * sigmas.position_m <= 0.010 && 3 * sigmas.rotation_rad <= 0.25 / kDeg;
        firm += is_firm ? 1 : 0;
        firm_ok += is_firm && estimate.status == PoseStatus::ok ? 1 : 0;
        if (estimate.status == PoseStatus::ok) ok.add(estimate, truth);
        if (!estimate.has_pose() || estimate.status == PoseStatus::ambiguous) continue;
        errors.add(estimate, truth);
        bound_position2 += bound->topLeftCorner<3, 3>().trace();
        bound_rotation2 += bound->bottomRightCorner<3, 3>().trace();
      }
      const double interval = 2.576 * std::sqrt(12.0 / std::max(1, errors.sets));
      fmt::print(
          "  {:<10} {:<6} {:5} posed: {:.3f} mm {:.4f}° = {:.3f} and {:.3f} x bound; NEES "
          "{:.3f} (6 ± {:.3f}); OK {:5}, of firm {:5}/{:5} = {:.2f} %; beyond {}\n",
          scene_name, rig_name, errors.sets, 1e3 * errors.rmse_m(), kDeg * errors.rmse_rad(),
          std::sqrt(errors.position2 / bound_position2),
          std::sqrt(errors.rotation2 / bound_rotation2), errors.nees / errors.sets, interval,
          ok.sets, firm_ok, firm, 100.0 * firm_ok / std::max(1, firm), ok.beyond);
    }
  }
}

}  // namespace waymark::bench
