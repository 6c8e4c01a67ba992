#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "bench/locd_accuracy/changed_building.h"
#include "bench/locd_accuracy/measurements.h"
#include "bench/locd_accuracy/pose_errors.h"
#include "bench/simulated_drive.h"
#include "locd/pose/localizer.h"

namespace waymark::bench {

/// (e): moved markers lose their pull, and are named.
void measure_moved(int sets) {
  fmt::print(
      "(e) moved markers, sets with >= 3 unmoved ones that are >= 2/3 of the visible: RMSE "
      "(bar 3 mm, pool 6 mm; 0.05°), sets beside >= 3 unmoved ones until named (bar 100)\n");
  struct Case {
    double distance_m, turn_rad;
  };
  for (const std::string scene_name : {"room1", "warehouse", "pool"}) {
    for (const Case& move : {Case{0.05, 0}, Case{0.1, 0}, Case{0.3, 0}, Case{0, 10 / kDeg}}) {
      const auto scene = scene_named(scene_name);
      const Rig rig = rig_named("cg120");
      simulator::Scene building = scene;
      simulator::Random random(7);
      std::set<std::size_t> moved;
      while (moved.size() < scene.markers.size() / 8) {
        const auto which = random.below(scene.markers.size());
        if (moved.insert(which).second) {
          move_marker(building, which, move.distance_m, move.turn_rad, random);
        }
      }
      DriveOptions options;
      options.period_s = 0.2;
      SimulatedDrive drive(building, rig, options);
      Localizer localizer(rig, true_map(scene), {});
      PoseEstimate estimate;
      Errors errors;
      std::map<MarkerId, int> chances, named_after;
      std::set<MarkerId> moved_ids;
      for (const std::size_t m : moved) moved_ids.insert(scene.markers[m].id);
      int wrongly = 0, cameras_wrongly = 0, qualifying = 0;
      for (int i = 0; i < sets; ++i) {
        const FrameSetLease set = drive.next();
        localizer.localize(set, estimate);
        std::set<std::size_t> seen(drive.visible().begin(), drive.visible().end());
        const auto still = std::count_if(seen.begin(), seen.end(),
                                         [&](std::size_t m) { return !moved.contains(m); });
        for (const std::size_t m : seen) {
          if (moved.contains(m) && still >= 3 && !named_after.contains(scene.markers[m].id)) {
            ++chances[scene.markers[m].id];
          }
        }
        for (const Alert& alert : localizer.alerts()) {
          if (alert.kind == AlertKind::extrinsics_off || alert.kind == AlertKind::cameras_swapped) {
            cameras_wrongly += alert.raised ? 1 : 0;
          }
          if (alert.kind != AlertKind::marker_moved) continue;
          if (!moved_ids.contains(*alert.marker)) {
            ++wrongly;
          } else if (alert.raised) {
            named_after.emplace(*alert.marker, chances[*alert.marker]);
          }
        }
        if (still < 3 || 3 * still < 2 * static_cast<std::ptrdiff_t>(seen.size())) continue;
        ++qualifying;
        if (estimate.status == PoseStatus::ok) {
          errors.add(estimate, drive.world_from_rig(estimate.stamp));
        }
      }
      int slowest = 0, missed = 0;
      for (const auto& [id, count] : chances) {
        if (named_after.contains(id)) {
          slowest = std::max(slowest, named_after[id]);
        } else if (count >= 100) {
          ++missed;
        }
      }
      fmt::print(
          "  {:<10} {:.2f} m {:2.0f}°: OK {}/{}, {:.2f} mm {:.4f}° RMSE, worst {:.1f} mm, "
          "beyond {}; {} of {} named, slowest after {} sets, {} not within 100; {} and {} cameras "
          "wrongly\n",
          scene_name, move.distance_m, kDeg * move.turn_rad, errors.sets, qualifying,
          1e3 * errors.rmse_m(), kDeg * errors.rmse_rad(), 1e3 * errors.worst_m, errors.beyond,
          named_after.size(), chances.size(), slowest, missed, wrongly, cameras_wrongly);
    }
  }
}

}  // namespace waymark::bench
