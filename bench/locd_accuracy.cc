// Accuracy and integrity of locd on simulated detections. Usage: bench_locd_accuracy
// [bound|faults|moved|skew|cameras] [SETS]; without an argument all of them. Alignment: none, poses
// are in the true map's frame.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "bench/simulated_drive.h"
#include "core/base/check.h"
#include "core/estimate/corner_residual.h"
#include "locd/localizer.h"
#include "simulator/rig_library.h"
#include "simulator/scene_library.h"

namespace waymark::bench {
namespace {

constexpr double kDeg = 180.0 / std::numbers::pi;

simulator::Scene scene_named(const std::string& name) {
  auto scene = simulator::load_scene(name);
  WAYMARK_CHECK(scene.has_value());
  return *scene;
}

Rig rig_named(const std::string& name) {
  auto rig = simulator::load_rig(name);
  WAYMARK_CHECK(rig.has_value());
  return rig->rig;
}

/// Errors of poses, and what was claimed of them.
struct Errors {
  int sets = 0;
  double position2 = 0, rotation2 = 0, nees = 0;
  double worst_m = 0, worst_rad = 0;
  int beyond = 0;  ///< farther than 20 mm and 3 sigma, or 0.5° and 3 sigma

  void add(const PoseEstimate& estimate, const Rigid3& truth) {
    const Vector6d error = estimate.world_from_rig.minus(truth);
    const double off_m = error.head<3>().norm();
    const double off_rad = error.tail<3>().norm();
    const PoseSigmas sigmas = worst_sigmas(estimate.covariance);
    ++sets;
    position2 += off_m * off_m;
    rotation2 += off_rad * off_rad;
    nees += error.dot(estimate.covariance.ldlt().solve(error));
    worst_m = std::max(worst_m, off_m);
    worst_rad = std::max(worst_rad, off_rad);
    if ((off_m > 0.020 && off_m > 3 * sigmas.position_m) ||
        (off_rad > 0.5 / kDeg && off_rad > 3 * sigmas.rotation_rad)) {
      ++beyond;
    }
  }
  [[nodiscard]] double rmse_m() const { return std::sqrt(position2 / std::max(1, sets)); }
  [[nodiscard]] double rmse_rad() const { return std::sqrt(rotation2 / std::max(1, sets)); }
};

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

/// A copy of the building in which one marker hangs elsewhere.
void move_marker(simulator::Scene& building, std::size_t marker, double distance_m, double turn_rad,
                 simulator::Random& random) {
  Rigid3& pose = building.markers[marker].world_from_marker;
  const Eigen::Vector3d normal = pose.rotation * Eigen::Vector3d::UnitZ();
  Eigen::Vector3d direction(random.normal(), random.normal(), random.normal());
  direction.normalize();
  if (direction.dot(normal) < 0) direction -= 2 * direction.dot(normal) * normal;  // not into walls
  pose.translation += distance_m * direction;
  Eigen::Vector3d axis(random.normal(), random.normal(), random.normal());
  pose.rotation = (so3_exp(turn_rad * axis.normalized()) * pose.rotation).normalized();
}

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

}  // namespace
}  // namespace waymark::bench

int main(int argc, char** argv) {
  using namespace waymark::bench;
  const std::string what = argc > 1 ? argv[1] : "all";
  const int sets = argc > 2 ? std::atoi(argv[2]) : 0;
  const auto wanted = [&](const char* name) { return what == name || what == "all"; };
  const auto count = [&](int usual) { return sets > 0 ? sets : usual; };
  if (wanted("bound")) measure_bound(count(2000));
  if (wanted("faults")) measure_faults(count(100'000));
  if (wanted("moved")) measure_moved(count(3000));
  if (wanted("skew")) measure_skew(count(3000));
  if (wanted("cameras")) measure_cameras(count(10'000));
}
