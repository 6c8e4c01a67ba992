#include "bench/locd_attacks/run_attack.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/geometry/decompositions.h"
#include "locd/pose/localizer.h"
#include "simulator/rig_library.h"
#include "simulator/scene_library.h"

namespace waymark::bench {
namespace {

constexpr double kDeg = 180.0 / std::numbers::pi;

/// What a user knows of it: who calibrated it, that rows are read out at once, and that edges are
/// where they are seen.
Rig told(Rig rig) {
  for (RigCamera& camera : rig.cameras) {
    camera.global_shutter = true;
    camera.stated_sigmas.edge_px = 0.02;
  }
  return rig;
}

World make_world(const Attack& attack, const AttackRun& run) {
  auto scene = simulator::load_scene(run.scene);
  auto rig = simulator::load_rig(run.rig == "mono" ? "cg120" : run.rig);
  WAYMARK_CHECK(scene.has_value() && rig.has_value());
  World world;
  world.building = *scene;
  world.rig = rig->rig;
  if (run.rig == "mono")
    world.rig.cameras.erase(world.rig.cameras.begin() + 1, world.rig.cameras.end());
  world.told_rig = told(world.rig);
  world.told_map = true_map(*scene);
  world.random = simulator::Random::of({run.seed, 77});
  world.drive.seed = run.seed;
  world.drive.speed_mps = 1.0;
  world.drive.start_m = 7.0 * static_cast<double>(run.seed);
  attack.prepare(world);
  return world;
}

double largest_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, symmetric_eigenvalues<3>(covariance).maxCoeff()));
}

void judge(const PoseEstimate& estimate, const Rigid3& truth, AttackFigures& figures) {
  ++figures.sets;
  if (estimate.has_pose() && !estimate.has(PoseReason::sigma)) ++figures.firm;
  for (unsigned shift = 0; shift < 32; ++shift) {
    const auto reason = static_cast<PoseReason>(1U << shift);
    if (estimate.has(reason)) ++figures.reasons[std::string(name_of(reason))];
  }
  if (estimate.status != PoseStatus::ok) return;
  ++figures.ok;
  ++figures.firm_ok;
  const Vector6d error = estimate.world_from_rig.minus(truth);
  const double off_m = error.head<3>().norm();
  const double off_rad = error.tail<3>().norm();
  const double sigma_m = largest_sigma(estimate.covariance.topLeftCorner<3, 3>());
  const double sigma_rad = largest_sigma(estimate.covariance.bottomRightCorner<3, 3>());
  const auto beyond = [&](double sigmas) {
    return (off_m > 0.020 && off_m > sigmas * sigma_m) ||
           (off_rad > 0.5 / kDeg && off_rad > sigmas * sigma_rad);
  };
  figures.nees += error.dot(Eigen::LDLT<Matrix6d>(estimate.covariance).solve(error));
  figures.beyond3 += beyond(3) ? 1 : 0;
  if (!beyond(5)) return;
  ++figures.wrong;
  figures.worst_m = std::max(figures.worst_m, off_m);
}

/// Who is named, and whether rightly.
void judge(const Alert& alert, const Attack& attack, const World& world, int set,
           AttackFigures& figures) {
  const bool right_kind =
      std::find(attack.causes.begin(), attack.causes.end(), alert.kind) != attack.causes.end();
  const bool guilty = alert.marker ? world.guilty_markers.contains(*alert.marker)
                                   : world.guilty_cameras.contains(alert.camera);
  const bool right = right_kind && (guilty || alert.camera < 0) && set >= attack.begins;
  figures.alerts +=
      fmt::format(" [{} {}{}{}]", set, name_of(alert.kind), alert.raised ? "" : " over",
                  alert.marker        ? fmt::format(" {}", alert.marker->number)
                  : alert.camera >= 0 ? fmt::format(" cam{}", alert.camera)
                                      : "");
  if (!alert.raised) {
    if (right) figures.over = 1;
    return;
  }
  if (right) {
    if (figures.named_after.empty()) figures.named_after.push_back(set - attack.begins);
  } else if (guilty && set >= attack.begins) {
    ++figures.other_causes;
  } else if (alert.kind == AlertKind::marker_moved || alert.kind == AlertKind::marker_riding) {
    ++figures.innocent_markers;
  } else if (alert.camera >= 0 && alert.kind != AlertKind::corners_noisy) {
    ++figures.innocent_cameras;
  }
}

}  // namespace

void AttackFigures::add(const AttackFigures& other) {
  runs += other.runs;
  sets += other.sets;
  ok += other.ok;
  firm += other.firm;
  firm_ok += other.firm_ok;
  wrong += other.wrong;
  beyond3 += other.beyond3;
  nees += other.nees;
  worst_m = std::max(worst_m, other.worst_m);
  after += other.after;
  after_ok += other.after_ok;
  innocent_markers += other.innocent_markers;
  innocent_cameras += other.innocent_cameras;
  other_causes += other.other_causes;
  named_after.insert(named_after.end(), other.named_after.begin(), other.named_after.end());
  over += other.over;
}

std::vector<Attack> all_attacks() {
  std::vector<Attack> all = image_attacks();
  for (const auto& more : {rig_attacks(), map_attacks()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

AttackFigures run_attack(const Attack& attack, const AttackRun& run) {
  World world = make_world(attack, run);
  SimulatedDrive drive(world.building, world.rig, world.drive);
  Localizer localizer(world.told_rig, world.told_map, {});
  PoseEstimate estimate;
  AttackFigures figures;
  figures.runs = 1;
  for (int i = 0; i < run.sets; ++i) {
    if (attack.before_set) attack.before_set(world, drive, i);
    FrameSetLease set = drive.next();
    if (attack.of_set) attack.of_set(set, i);
    localizer.localize(set, estimate);
    for (const Alert& alert : localizer.alerts()) judge(alert, attack, world, i, figures);
    if (attack.ends && i >= *attack.ends + 100) {
      ++figures.after;
      figures.after_ok += estimate.status == PoseStatus::ok ? 1 : 0;
    }
    if (i >= attack.begins) judge(estimate, drive.world_from_rig(estimate.stamp), figures);
  }
  return figures;
}

std::string reasons_of(const AttackFigures& figures) {
  std::string text = "not OK for";
  for (const auto& [reason, sets] : figures.reasons) text += fmt::format(" {} {}", reason, sets);
  return text;
}

std::string row_of(const AttackFigures& figures) {
  const auto per = [](double part, double whole) { return whole > 0 ? part / whole : 0.0; };
  std::vector<int> named = figures.named_after;
  std::sort(named.begin(), named.end());
  std::string row = fmt::format(
      "OK {:5.1f} % (of firm {:5.1f}), wrong {:6.1f}, beyond 3 sigma {:6.1f} per 1000; NEES/6 "
      "{:8.2f}; "
      "innocents {:3} markers {:2} cameras, other causes {:2}; named {} of {}",
      100 * per(figures.ok, figures.sets), 100 * per(figures.firm_ok, figures.firm),
      1000 * per(figures.wrong, figures.sets), 1000 * per(figures.beyond3, figures.sets),
      per(figures.nees / 6, figures.ok), figures.innocent_markers, figures.innocent_cameras,
      figures.other_causes, named.size(), figures.runs);
  if (!named.empty()) {
    row += fmt::format(", median after {} sets, last {}", named[named.size() / 2], named.back());
  }
  if (figures.over > 0) row += fmt::format(", over in {}", figures.over);
  if (figures.after > 0)
    row += fmt::format("; OK after its end {:.1f} %", 100 * per(figures.after_ok, figures.after));
  if (figures.wrong > 0) row += fmt::format("; worst {:.2f} m", figures.worst_m);
  return row;
}

}  // namespace waymark::bench
