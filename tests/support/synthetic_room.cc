#include "tests/support/synthetic_room.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "core/base/check.h"
#include "core/camera/rig_parameters.h"

namespace waymark::test {
namespace {

constexpr double kPi = std::numbers::pi;

/// A marker on the wall that lies at `angle` around the room, looking inwards.
Rigid3 on_wall(int wall, double along_m, double height_m, double room_m) {
  // Marker axes seen from inside: x right, y up, z towards the middle.
  const double angle = 0.5 * kPi * wall;
  const Eigen::Vector3d normal(-std::cos(angle), -std::sin(angle), 0);
  const Eigen::Vector3d up(0, 0, 1);
  Eigen::Matrix3d axes;
  axes << up.cross(normal), up, normal;
  const Eigen::Vector3d position =
      -0.5 * room_m * normal + along_m * up.cross(normal) + height_m * up;
  return {Eigen::Quaterniond(axes), position};
}

CameraModel camera_of_90_degrees() {
  CameraParameters p;
  p.width_px = 1280;
  p.height_px = 960;
  p.fu_px = p.fv_px = 640;
  p.pu_px = 639.5;
  p.pv_px = 479.5;
  auto model = CameraModel::create(p);
  WAYMARK_CHECK(model.has_value());
  return *model;
}

std::optional<ImageCorners> view(const RigCamera& camera, const Rigid3& cam_from_marker,
                                 double size_m) {
  const Eigen::Vector3d normal = cam_from_marker.rotation * Eigen::Vector3d::UnitZ();
  const double cosine = normal.dot(-cam_from_marker.translation.normalized());
  if (cosine < std::cos(75.0 * kPi / 180.0)) return std::nullopt;
  ImageCorners corners;
  const auto x_in_marker = marker_corners(size_m);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = camera.model.project(cam_from_marker * x_in_marker[i]);
    if (!pixel || !camera.model.in_image(*pixel)) return std::nullopt;
    corners[i] = *pixel;
  }
  return corners;
}

}  // namespace

Rig ring_rig(int cameras) {
  Rig rig;
  // Rig axes: x forward, y left, z up; camera axes: x right, y down, z forward.
  Eigen::Matrix3d rig_from_forward_camera;
  rig_from_forward_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  for (int i = 0; i < cameras; ++i) {
    const Eigen::Quaterniond turn = so3_exp({0, 0, 2 * kPi * i / cameras});
    rig.cameras.push_back(
        {"cam" + std::to_string(i),
         camera_of_90_degrees(),
         {turn * Eigen::Quaterniond(rig_from_forward_camera), turn * Eigen::Vector3d(0.1, 0, 0)},
         {},
         {},
         {},
         {},
         {}});
  }
  return stated_exact(std::move(rig));
}

Stamp room_stamp(int index) {
  return std::chrono::seconds(1) + std::chrono::milliseconds(100 * index);
}

SyntheticRoom make_room(const RoomOptions& options) {
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> normal;
  SyntheticRoom room;
  room.rig = ring_rig(options.cameras);
  MarkerCatalog::FamilyEntry family;
  family.family = Family::tag36h11;
  family.default_size_m = options.marker_m;
  room.catalog = MarkerCatalog({family}).with_exact_sizes();

  const double reach = 0.5 * options.room_m - options.marker_m;
  const int per_wall = (options.markers + 3) / 4;
  for (int i = 0; i < options.markers; ++i) {
    const double along = -reach + 2 * reach * (i / 4 + 0.5) / per_wall;
    Rigid3 pose = on_wall(i % 4, along, 1.5 + 0.8 * unit(random), options.room_m);
    // Stuck on by hand: a little turned in its plane and off the wall.
    pose.rotation = pose.rotation * so3_exp({0.1 * unit(random), 0.1 * unit(random), unit(random)});
    room.world_from_marker.push_back(pose);
  }
  for (int i = 0; i < options.frame_sets; ++i) {
    if (options.turn_in_place_rad >= 0) {
      room.world_from_rig.push_back(
          {so3_exp({0, 0, options.turn_in_place_rad * i / options.frame_sets}), {0, 0, 1.4}});
      continue;
    }
    const double angle = 2 * kPi * i / options.frame_sets;
    const double radius = 0.25 * options.room_m;
    room.world_from_rig.push_back(
        {so3_exp({0.05 * std::sin(3 * angle), 0.05 * std::cos(2 * angle), 2 * angle}),
         {radius * std::cos(angle), radius * std::sin(angle), 1.4 + 0.3 * std::sin(2 * angle)}});
  }
  for (int i = 0; i < options.frame_sets; ++i) {
    for (int c = 0; c < options.cameras; ++c) {
      const RigCamera& camera = room.rig.cameras[static_cast<std::size_t>(c)];
      ImageDetections image{room_stamp(i), c, {}};
      const Rigid3 cam_from_world = camera.rig_from_cam.inverse() *
                                    room.world_from_rig[static_cast<std::size_t>(i)].inverse();
      for (std::size_t m = 0; m < room.world_from_marker.size(); ++m) {
        auto corners = view(camera, cam_from_world * room.world_from_marker[m], options.marker_m);
        if (!corners) continue;
        Detection d;
        d.marker = {Family::tag36h11, static_cast<int>(m)};
        for (Eigen::Vector2d& corner : *corners) {
          corner.x() += options.noise_px * normal(random);
          corner.y() += options.noise_px * normal(random);
        }
        d.corners = *corners;
        if (options.state_covariances) {
          CornerCovariances covariances;
          covariances.fill(options.noise_px * options.noise_px * Eigen::Matrix2d::Identity());
          d.covariances = covariances;
        }
        image.detections.push_back(d);
      }
      room.images.push_back(image);
    }
  }
  return room;
}

void hang(SyntheticRoom& room, int number, const Rigid3& world_from_marker, double size_m,
          const std::function<bool(Stamp)>& there) {
  for (ImageDetections& image : room.images) {
    if (!there(image.stamp)) continue;
    const auto set =
        static_cast<std::size_t>((image.stamp - room_stamp(0)) / (room_stamp(1) - room_stamp(0)));
    const RigCamera& camera = room.rig.cameras[static_cast<std::size_t>(image.camera)];
    const Rigid3 cam_from_world =
        camera.rig_from_cam.inverse() * room.world_from_rig[set].inverse();
    const auto corners = view(camera, cam_from_world * world_from_marker, size_m);
    if (!corners) continue;
    Detection d;
    d.marker = {Family::tag36h11, number};
    d.corners = *corners;
    image.detections.push_back(d);
  }
}

}  // namespace waymark::test
