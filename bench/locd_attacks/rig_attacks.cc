#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "bench/locd_attacks/attack.h"
#include "core/base/check.h"

namespace waymark::bench {
namespace {

constexpr double kRad = std::numbers::pi / 180.0;

Eigen::Vector3d direction(simulator::Random& random) {
  Eigen::Vector3d v(random.normal(), random.normal(), random.normal());
  return v.normalized();
}

CameraModel changed(const CameraModel& model, double focal_share, double du_px, double dv_px,
                    double dk1) {
  CameraParameters p = model.parameters();
  p.fu_px *= 1 + focal_share;
  p.fv_px *= 1 + focal_share;
  p.pu_px += du_px;
  p.pv_px += dv_px;
  p.coefficients[0] += dk1;
  auto made = CameraModel::create(p);
  WAYMARK_CHECK(made.has_value());
  return *made;
}

Rigid3 knocked(const Rigid3& pose, double turn_rad, double move_m, simulator::Random& random) {
  return {pose.rotation * so3_exp(turn_rad * direction(random)),
          pose.translation + move_m * direction(random)};
}

/// As good as calibrations and clocks (1 ms) are, in the true rig: locd has the stated one.
Attack calibration() {
  return {"calibration 0.05 deg 1 mm 0.1 % 0.5 px k1 0.005",
          [](World& w) {
            auto& r = w.random;
            for (std::size_t c = 0; c < w.rig.cameras.size(); ++c) {
              RigCamera& camera = w.rig.cameras[c];
              camera.model = changed(camera.model, 1e-3 * r.normal(), 0.5 * r.normal(),
                                     0.5 * r.normal(), 0.005 * r.normal());
              w.drive.late_s[c] = 1e-3 * r.normal();
              if (c == 0) continue;
              Vector6d e;
              for (int i = 0; i < 3; ++i) e[i] = 1e-3 * r.normal();
              for (int i = 3; i < 6; ++i) e[i] = 0.05 * kRad * r.normal();
              camera.rig_from_cam = camera.rig_from_cam.plus(e);
            }
          },
          {},
          {},
          0,
          {},
          {},
          false};
}

Attack knock(int begins, std::optional<int> ends, std::string name) {
  return {std::move(name),
          [](World& w) {
            w.touched_camera = static_cast<int>(w.random.below(w.rig.cameras.size()));
            w.guilty_cameras = {w.touched_camera};
          },
          [=](World& w, SimulatedDrive& drive, int set) {
            if (set == begins) {
              Rig rig = w.rig;
              Rigid3& pose = rig.cameras[static_cast<std::size_t>(w.touched_camera)].rig_from_cam;
              pose = knocked(pose, w.random.uniform(1, 2) * kRad, 0.002, w.random);
              drive.mount(rig);
            }
            if (ends && set == *ends) drive.mount(w.rig);
          },
          {},
          begins,
          ends,
          {AlertKind::extrinsics_off},
          true};
}

Attack lens(double focal_share, double dk1, std::string name, std::vector<AlertKind> causes) {
  return {std::move(name),
          [=](World& w) {
            w.touched_camera = static_cast<int>(w.random.below(w.rig.cameras.size()));
            w.guilty_cameras = {w.touched_camera};
            RigCamera& camera = w.rig.cameras[static_cast<std::size_t>(w.touched_camera)];
            camera.model = changed(camera.model, focal_share, 0, 0, dk1);
          },
          {},
          {},
          0,
          {},
          std::move(causes),
          false};
}

Attack late(double seconds, std::vector<AlertKind> causes, std::string name) {
  return {std::move(name),
          [=](World& w) {
            w.touched_camera = static_cast<int>(w.random.below(w.rig.cameras.size()));
            w.guilty_cameras = {w.touched_camera};
            w.drive.late_s[static_cast<std::size_t>(w.touched_camera)] = seconds;
          },
          {},
          {},
          0,
          {},
          std::move(causes),
          true};
}

Attack readout(double seconds, std::vector<AlertKind> causes) {
  return {"read-out of 10 ms undeclared",
          [=](World& w) {
            w.drive.readout_s = seconds;
            for (std::size_t c = 0; c < w.rig.cameras.size(); ++c) {
              w.guilty_cameras.insert(static_cast<int>(c));
              w.told_rig.cameras[c].global_shutter.reset();
            }
          },
          {},
          {},
          0,
          {},
          std::move(causes),
          false};
}

Attack parked() {
  return {"parked, k1 off by 0.02",
          [](World& w) {
            w.drive.speed_mps = 0;
            w.touched_camera = static_cast<int>(w.random.below(w.rig.cameras.size()));
            w.guilty_cameras = {w.touched_camera};
            RigCamera& camera = w.rig.cameras[static_cast<std::size_t>(w.touched_camera)];
            camera.model = changed(camera.model, 0, 0, 0, 0.02);
          },
          {},
          {},
          0,
          {},
          {},
          false};
}

Attack swapped() {
  return {"two cameras swapped, right again at 600",
          [](World& w) {
            w.guilty_cameras = {1, 2};
          },
          [](World& w, SimulatedDrive& drive, int set) {
            if (set == 200) {
              Rig rig = w.rig;
              std::swap(rig.cameras[1].model, rig.cameras[2].model);
              std::swap(rig.cameras[1].rig_from_cam, rig.cameras[2].rig_from_cam);
              drive.mount(rig);
            }
            if (set == 600) drive.mount(w.rig);
          },
          {},
          200,
          600,
          {AlertKind::cameras_swapped},
          true};
}

}  // namespace

std::vector<Attack> rig_attacks() {
  using K = AlertKind;
  return {
      calibration(),
      knock(0, {}, "camera knocked by 1-2 deg at 0"),
      knock(100, {}, "camera knocked by 1-2 deg at 100"),
      knock(600, {}, "camera knocked by 1-2 deg at 600"),
      knock(300, 800, "camera knocked 300-800"),
      lens(0.01, 0, "f + 1 %", {K::lens_off}),
      lens(-0.02, 0, "f - 2 %", {K::lens_off}),
      lens(0, 0.05, "k1 + 0.05", {K::lens_off}),
      late(0.02, {K::stamps_skewed}, "one camera 20 ms late"),
      late(0.1, {K::stamps_skewed}, "one camera 100 ms late"),
      late(0.2, {K::stamps_skewed}, "one camera 200 ms late"),
      readout(0.010, {K::readout_off}),
      parked(),
      swapped(),
  };
}

}  // namespace waymark::bench
