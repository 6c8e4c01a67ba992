#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "bench/locd_accuracy/measurements.h"
#include "bench/locd_accuracy/pose_errors.h"
#include "bench/simulated_drive.h"
#include "locd/pose/localizer.h"

namespace waymark::bench {
namespace {

/// A circle round `centre` that 1.5 m/s turn into 30°/s.
simulator::TrajectoryPlan circle(const Eigen::Vector3d& centre_m) {
  const double radius_m = 1.5 / (30 / kDeg);
  simulator::TrajectoryPlan plan;
  for (int i = 0; i < 24; ++i) {
    const double angle = i * 2 * std::numbers::pi / 24;
    plan.waypoints.push_back(
        {centre_m + radius_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0)});
  }
  return plan;
}

}  // namespace

/// (f): cameras that expose one after the other, on the move.
void measure_skew(int sets) {
  fmt::print(
      "(f) exposures at 0/11/22 ms, 1.5 m/s, 30 Hz, room1 and pool in a circle at 30°/s, the "
      "warehouse's aisles where its turns are not above 35°/s for 0.5 s: RMSE (bar 3 mm, "
      "pool 6 mm; 0.05°)\n");
  for (const std::string scene_name : {"room1", "warehouse", "pool"}) {
    auto scene = scene_named(scene_name);
    const double height_m = scene.trajectory.waypoints.front().at_m.z();
    if (scene_name == "room1") scene.trajectory = circle({4.5, 3.5, height_m});
    if (scene_name == "pool") scene.trajectory = circle({12, 8, height_m});
    const Rig rig = rig_named("cg120");
    DriveOptions options;
    options.speed_mps = 1.5;
    options.period_s = 1.0 / 30;
    options.offset_s = {0, 0.011, 0.022};
    SimulatedDrive drive(scene, rig, options);
    Localizer localizer(rig, true_map(scene), {});
    PoseEstimate estimate;
    Errors errors;
    std::map<ReasonBits, int> reasons;
    int calm = 0, calm_for = 0;
    for (int i = 0; i < sets; ++i) {
      const FrameSetLease set = drive.next();
      localizer.localize(set, estimate);
      calm_for = drive.turn_rate(estimate.stamp) <= 35 / kDeg ? calm_for + 1 : 0;
      if (calm_for < 15) continue;
      ++calm;
      if (estimate.status != PoseStatus::ok) {
        ++reasons[estimate.reasons];
        continue;
      }
      errors.add(estimate, drive.world_from_rig(estimate.stamp));
    }
    std::string why;
    for (const auto& [bits, count] : reasons) why += fmt::format(" {:#x}: {}", bits, count);
    fmt::print("  {:<10} OK {}/{}: {:.2f} mm {:.4f}° RMSE, NEES {:.2f}, beyond {}; not OK for{}\n",
               scene_name, errors.sets, calm, 1e3 * errors.rmse_m(), kDeg * errors.rmse_rad(),
               errors.nees / std::max(1, errors.sets), errors.beyond, why.empty() ? " none" : why);
  }
}

}  // namespace waymark::bench
