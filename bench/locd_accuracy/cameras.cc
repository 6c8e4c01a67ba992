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

std::string alerts_of_cameras(const Rig& true_rig, const Rig& stated, const std::string& scene_name,
                              int sets, std::uint64_t seed, int& named_at) {
  const auto scene = scene_named(scene_name);
  DriveOptions options;
  options.period_s = 0.2;
  options.seed = seed;
  SimulatedDrive drive(scene, true_rig, options);
  Localizer localizer(stated, true_map(scene), {});
  PoseEstimate estimate;
  std::string text;
  int others = 0, beyond = 0;
  named_at = -1;
  for (int i = 0; i < sets; ++i) {
    const FrameSetLease set = drive.next();
    localizer.localize(set, estimate);
    for (const Alert& alert : localizer.alerts()) {
      const bool of_camera =
          alert.kind == AlertKind::extrinsics_off || alert.kind == AlertKind::cameras_swapped;
      if (named_at < 0 && of_camera) named_at = i;
      if (of_camera) {
        text += fmt::format(" [{} {} {}{} {:.2f}°]", i, name_of(alert.kind), alert.camera,
                            alert.raised ? "" : " over", kDeg * alert.offset_rad);
      } else {
        ++others;
      }
    }
    beyond += estimate.status == PoseStatus::ok &&
                      (estimate.world_from_rig.minus(drive.world_from_rig(estimate.stamp)))
                              .head<3>()
                              .norm() > 0.02
                  ? 1
                  : 0;
  }
  if (others > 0) text += fmt::format(" [{} other alerts]", others);
  if (beyond > 0) text += fmt::format(" [{} OK poses beyond 20 mm]", beyond);
  return text;
}

}  // namespace

/// (g): a camera that does not stand where the rig file says, two in each other's place.
void measure_cameras(int sets) {
  fmt::print("(g) set at which it was named (bar 200), and all alerts [set kind camera]\n");
  for (const std::string scene_name : {"room1", "warehouse", "pool"}) {
    for (const std::string rig_name : {"cg120", "cg60"}) {
      const Rig rig = rig_named(rig_name);
      simulator::Random random(3);
      for (std::size_t c = 0; c < 3; ++c) {
        Rig off = rig;
        Eigen::Vector3d axis(random.normal(), random.normal(), random.normal());
        off.cameras[c].rig_from_cam.rotation =
            off.cameras[c].rig_from_cam.rotation * so3_exp(axis.normalized() / kDeg);
        int named_at = 0;
        const auto alerts = alerts_of_cameras(rig, off, scene_name, 400, c + 1, named_at);
        fmt::print("  {:<10} {:<6} cam{} off by 1°: {}{}\n", scene_name, rig_name, c, named_at,
                   alerts);
        Rig swapped = rig;
        const std::size_t other = (c + 1) % 3;
        std::swap(swapped.cameras[c].model, swapped.cameras[other].model);
        std::swap(swapped.cameras[c].rig_from_cam, swapped.cameras[other].rig_from_cam);
        const auto swap_alerts = alerts_of_cameras(rig, swapped, scene_name, 400, c + 1, named_at);
        fmt::print("  {:<10} {:<6} cam{} and cam{} swapped: {}{}\n", scene_name, rig_name, c, other,
                   named_at, swap_alerts);
      }
    }
    int named_at = 0;
    const Rig rig = rig_named("cg120");
    const auto alerts = alerts_of_cameras(rig, rig, scene_name, sets, 9, named_at);
    fmt::print("  {:<10} nothing wrong, {} sets:{}\n", scene_name, sets,
               alerts.empty() ? " no alert" : alerts);
  }
}

}  // namespace waymark::bench
