#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "core/geometry/so3.h"
#include "mapbuilder/observations/detected_capture.h"
#include "tests/support/synthetic_room.h"

namespace waymark::test {

/// A kind of rig: cameras every so many degrees round the rig, each a little lower than the one
/// before, with a lens of its own.
struct RigKind {
  const char* name;
  int cameras;
  double step_deg;
  Distortion distortion;
};

/// Narrow, all around, alone, and wide-eyed.
inline constexpr RigKind kRigKinds[] = {{"cg60", 3, 60, Distortion::radtan},
                                        {"cg120", 3, 120, Distortion::radtan},
                                        {"mono", 1, 0, Distortion::radtan},
                                        {"fisheye", 2, 75, Distortion::equidistant}};

inline Rig rig_of(const RigKind& kind) {
  Eigen::Matrix3d rig_from_forward_camera;
  rig_from_forward_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Rig rig;
  for (int k = 0; k < kind.cameras; ++k) {
    CameraParameters p;
    p.width_px = 1280;
    p.height_px = 960;
    p.fu_px = 640 + 4 * k;
    p.fv_px = 641 + 4 * k;
    p.pu_px = 628 + 11 * k;
    p.pv_px = 489 - 7 * k;
    p.distortion = kind.distortion;
    p.coefficients = kind.distortion == Distortion::equidistant
                         ? LensCoefficients{0.03 + 0.002 * k, -0.01, 0.002, 0}
                         : LensCoefficients{-0.11 - 0.004 * k, 0.02, 0.0005, -0.0004};
    const Eigen::Quaterniond turn = so3_exp({0, 0, kind.step_deg * k * std::numbers::pi / 180});
    rig.cameras.push_back(
        {"cam" + std::to_string(k),
         *CameraModel::create(p),
         {turn * Eigen::Quaterniond(rig_from_forward_camera),
          turn * Eigen::Vector3d(0.12, 0.01 * k, 0) - Eigen::Vector3d(0, 0, 0.03 * k * k)},
         {},
         {},
         {},
         {},
         {}});
  }
  return rig;
}

/// What a rig sees in a room, with Gaussian noise, of prints `stretch` times as wide as high.
inline DetectedCapture seen_room(const SyntheticRoom& room, const Rig& rig, double noise_px,
                                 unsigned seed, double stretch = 1.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  DetectedCapture capture{"room", rig, room.catalog, {}, kDefaultSyncTolerance};
  const double size_m = *room.catalog.entries().front().default_size_m;
  auto corners_m = marker_corners(size_m);
  for (Eigen::Vector3d& corner : corners_m) {
    corner.x() *= std::sqrt(stretch);
    corner.y() /= std::sqrt(stretch);
  }
  for (std::size_t f = 0; f < room.world_from_rig.size(); ++f) {
    for (std::size_t k = 0; k < rig.cameras.size(); ++k) {
      const RigCamera& camera = rig.cameras[k];
      const Rigid3 cam_from_world =
          camera.rig_from_cam.inverse() * room.world_from_rig[f].inverse();
      ImageDetections image{room_stamp(static_cast<int>(f)), static_cast<int>(k), {}};
      for (std::size_t m = 0; m < room.world_from_marker.size(); ++m) {
        const Rigid3 cam_from_marker = cam_from_world * room.world_from_marker[m];
        const Eigen::Vector3d facing = cam_from_marker.rotation * Eigen::Vector3d::UnitZ();
        if (facing.dot(-cam_from_marker.translation.normalized()) < 0.35) continue;
        Detection d;
        d.marker = {Family::tag36h11, static_cast<int>(m)};
        bool whole = true;
        for (std::size_t i = 0; i < 4 && whole; ++i) {
          const auto pixel = camera.model.project(cam_from_marker * corners_m[i]);
          whole = pixel && camera.model.in_image(*pixel);
          if (whole)
            d.corners[i] = *pixel + noise_px * Eigen::Vector2d(normal(random), normal(random));
        }
        if (whole) image.detections.push_back(d);
      }
      capture.images.push_back(image);
    }
  }
  return capture;
}

}  // namespace waymark::test
