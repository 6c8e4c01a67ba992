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

/// (d): everything goes wrong at once; no OK pose may be wrong.
void measure_faults(int sets) {
  fmt::print(
      "(d) 2 % misread, 5 % missed, 2 % of images lost, 3 twins and 5 moved markers per 1000 "
      "sets: OK poses off by more than 20 mm and 3 sigma, or 0.5° and 3 sigma (bar 0)\n");
  constexpr int kBlock = 1000;
  Errors all;
  int total = 0, single = 0, moved_named = 0, wrongly_named = 0;
  for (int block = 0; total < sets; ++block) {
    const std::array<std::string, 4> names = {"room1", "warehouse", "pool", "corridor"};
    const auto scene = scene_named(names[static_cast<std::size_t>(block) % 4]);
    const Rig rig = rig_named(block % 3 == 0 ? "cg60" : "cg120");
    simulator::Random random(static_cast<std::uint64_t>(1000 + block));
    DriveOptions options;
    options.seed = static_cast<std::uint64_t>(block + 1);
    options.miss_rate = 0.05;
    options.false_rate = 0.02;
    options.drop_out_rate = 0.02;
    options.period_s = block % 2 == 0 ? 0.1 : 0.8;  // with a prior, and without
    simulator::Scene building = scene;
    for (int i = 0; i < 3; ++i) {  // an id in two places: that of another marker, reprinted
      const auto a = random.below(building.markers.size());
      const auto b = random.below(building.markers.size());
      building.markers[a].id = building.markers[b].id;
    }
    SimulatedDrive drive(building, rig, options);
    Localizer localizer(rig, true_map(scene), {});
    PoseEstimate estimate;
    Errors errors;
    std::set<MarkerId> wrong;
    for (std::size_t i = 0; i < scene.markers.size(); ++i) {
      if (building.markers[i].id != scene.markers[i].id) {
        wrong.insert(scene.markers[i].id);
        wrong.insert(building.markers[i].id);
      }
    }
    for (int i = 0; i < kBlock; ++i, ++total) {
      if (i == kBlock / 4) {
        for (int m = 0; m < 5; ++m) {
          const auto which = random.below(building.markers.size());
          wrong.insert(building.markers[which].id);
          const bool turned = random.uniform() < 0.2;
          move_marker(building, which, turned ? 0 : random.uniform(0.05, 0.3),
                      turned ? 10 / kDeg : 0, random);
        }
        drive.rebuild(building);
      }
      const FrameSetLease set = drive.next();
      localizer.localize(set, estimate);
      for (const Alert& alert : localizer.alerts()) {
        if (alert.kind != AlertKind::marker_moved || !alert.raised) continue;
        ++(wrong.contains(*alert.marker) ? moved_named : wrongly_named);
      }
      if (estimate.status != PoseStatus::ok) continue;
      single += estimate.markers_used == 1 ? 1 : 0;
      const int before = errors.beyond;
      errors.add(estimate, drive.world_from_rig(estimate.stamp));
      if (errors.beyond > before) {
        const Vector6d e = estimate.world_from_rig.minus(drive.world_from_rig(estimate.stamp));
        fmt::print(
            "  beyond: block {} set {}: {:.1f} mm {:.3f}°, {} markers used, {} outliers, "
            "sigma {:.1f} mm\n",
            block, i, 1e3 * e.head<3>().norm(), kDeg * e.tail<3>().norm(), estimate.markers_used,
            estimate.outliers, 1e3 * worst_sigmas(estimate.covariance).position_m);
      }
    }
    all.sets += errors.sets;
    all.beyond += errors.beyond;
    all.position2 += errors.position2;
    all.rotation2 += errors.rotation2;
    all.worst_m = std::max(all.worst_m, errors.worst_m);
    all.worst_rad = std::max(all.worst_rad, errors.worst_rad);
  }
  fmt::print(
      "  {} sets, {} OK ({} by one marker and the prior): {:.2f} mm {:.4f}° RMSE, worst {:.1f} "
      "mm {:.3f}°; beyond: {}; named {} rightly, {} wrongly\n",
      total, all.sets, single, 1e3 * all.rmse_m(), kDeg * all.rmse_rad(), 1e3 * all.worst_m,
      kDeg * all.worst_rad, all.beyond, moved_named, wrongly_named);
}

}  // namespace waymark::bench
