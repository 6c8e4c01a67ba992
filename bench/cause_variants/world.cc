#include "bench/cause_variants/world.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/check.h"
#include "core/geometry/so3.h"
#include "core/marker/marker_geometry.h"
#include "simulator/scene_library.h"
#include "simulator/visibility.h"

namespace waymark::bench {
namespace {

using simulator::Random;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr std::array<const char*, 6> kScenes = {"room1",    "room2",     "pool",
                                                "corridor", "warehouse", "calibration"};
/// Stamp of the first set; any epoch would do, this one looks like a clock's.
constexpr Stamp kStart = std::chrono::seconds(1'700'000'000);

Stamp to_stamp(double seconds) { return Stamp(std::llround(seconds * 1e9)); }

Eigen::Vector3d scattered(double most, Random& random) {
  return {random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most)};
}

/// Focal length of a rig's lenses: 40° across as machine vision has them, 80°, or a fisheye's 130°.
double focal_length_px(RigKind kind, Random& random) {
  constexpr double kNarrow_px = 1250;
  constexpr double kUsual_px = 720;
  constexpr double kFisheye_px = 520;
  if (kind == RigKind::fisheye) return kFisheye_px;
  return kind != RigKind::mono && random.uniform() < 0.4 ? kNarrow_px : kUsual_px;
}

/// Lenses of one kind are never the same.
CameraModel lens_of(RigKind kind, double focal_px, Random& random) {
  CameraParameters p;
  const bool wide = kind == RigKind::fisheye;
  p.width_px = wide ? 1280 : 1224;
  p.height_px = wide ? 960 : 1024;
  p.fu_px = focal_px * random.uniform(0.96, 1.04);
  p.fv_px = p.fu_px * random.uniform(0.998, 1.002);
  p.pu_px = 0.5 * (p.width_px - 1) + random.uniform(-15, 15);
  p.pv_px = 0.5 * (p.height_px - 1) + random.uniform(-15, 15);
  if (wide) {
    p.distortion = Distortion::equidistant;
    p.coefficients = {random.uniform(0.02, 0.04), random.uniform(-0.012, -0.008), 0.002, 0};
  } else {
    p.distortion = Distortion::radtan;
    p.coefficients = {random.uniform(-0.13, -0.09), random.uniform(0.11, 0.17), 0.0004, -0.0005};
  }
  auto model = CameraModel::create(p);
  WAYMARK_CHECK(model.has_value());
  return *model;
}

Rig rig_of(RigKind kind, Random& random) {
  const std::vector<double> yaws_deg = kind == RigKind::cg60    ? std::vector<double>{0, 60, -60}
                                       : kind == RigKind::cg120 ? std::vector<double>{0, 120, -120}
                                       : kind == RigKind::fisheye ? std::vector<double>{0, 75}
                                                                  : std::vector<double>{0};
  Eigen::Matrix3d forward;
  forward << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const double focal_px = focal_length_px(kind, random);
  Rig rig;
  for (std::size_t k = 0; k < yaws_deg.size(); ++k) {
    const Eigen::Quaterniond turn = so3_exp({0, 0, yaws_deg[k] * kRadPerDeg});
    const Rigid3 mounted{
        turn * so3_exp(scattered(3 * kRadPerDeg, random)) * Eigen::Quaterniond(forward),
        turn * Eigen::Vector3d(0.12, 0, 0) + scattered(0.02, random)};
    rig.cameras.push_back({.name = fmt::format("cam{}", k),
                           .model = lens_of(kind, focal_px, random),
                           .rig_from_cam = mounted,
                           .serial = "",
                           .lens_id = "",
                           .readout_us = std::nullopt,
                           .global_shutter = std::nullopt,
                           .timeshift_cam_imu_s = std::nullopt});
  }
  const Rigid3 cam0_from_axis = rig.cameras.front().rig_from_cam.inverse();
  for (RigCamera& camera : rig.cameras) camera.rig_from_cam = cam0_from_axis * camera.rig_from_cam;
  return rig;
}

/// The building as it is at a set.
simulator::Scene scene_at(const World& world, std::size_t set) {
  simulator::Scene scene = world.scene;
  for (const auto& [marker, places] : world.wandering) {
    scene.markers[marker].world_from_marker = places[set];
  }
  return scene;
}

/// Corners of a marker that is not square, where a camera sees them.
ImageCorners corners_of(const simulator::PlacedMarker& marker, double wider,
                        const CameraModel& camera, const Rigid3& world_from_cam,
                        const ImageCorners& square) {
  ImageCorners corners = square;
  const Rigid3 cam_from_marker = world_from_cam.inverse() * marker.world_from_marker;
  const auto at = marker_corners(marker.size_m);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel =
        camera.project(cam_from_marker * Eigen::Vector3d(at[i].x() * std::sqrt(wider),
                                                         at[i].y() / std::sqrt(wider), 0));
    if (pixel) corners[i] = *pixel;
  }
  return corners;
}

class Onlooker {
 public:
  explicit Onlooker(const World& world) : world_(world), visibility_(world.scene) {}

  [[nodiscard]] ImageDetections look(std::size_t set, std::size_t camera) const {
    const CameraModel& model = world_.rig.cameras[camera].model;
    const Rigid3 world_from_cam =
        world_.world_from_rig(world_.exposed_s[set][camera]) * rig_from_cam(set, camera);
    ImageDetections image{world_.stamps[set][camera], static_cast<int>(camera), {}};
    Random random = Random::of({world_.seed, set, camera});
    const auto see = [&](const simulator::Scene& scene, const simulator::Visibility& visibility) {
      for (const auto& seen : visibility.visible_from(model, world_from_cam)) {
        Detection detection;
        detection.marker = scene.markers[seen.marker].id;
        const auto wider = world_.wider.find(seen.marker);
        detection.corners = wider == world_.wider.end()
                                ? seen.corners
                                : corners_of(scene.markers[seen.marker], wider->second, model,
                                             world_from_cam, seen.corners);
        for (Eigen::Vector2d& corner : detection.corners) {
          corner += world_.noise_px * Eigen::Vector2d(random.normal(), random.normal());
        }
        if (world_.with_covariances) {
          detection.covariances.emplace();
          detection.covariances->fill(world_.noise_px * world_.noise_px *
                                      Eigen::Matrix2d::Identity());
        }
        image.detections.push_back(detection);
      }
    };
    if (world_.wandering.empty()) {
      see(world_.scene, visibility_);
    } else {
      const simulator::Scene scene = scene_at(world_, set);
      see(scene, simulator::Visibility(scene));
    }
    return image;
  }

 private:
  [[nodiscard]] Rigid3 rig_from_cam(std::size_t set, std::size_t camera) const {
    for (const World::Bump& bump : world_.bumps) {
      if (bump.camera == camera && set >= bump.from_set) return bump.rig_from_cam;
    }
    return world_.rig.cameras[camera].rig_from_cam;
  }

  const World& world_;
  simulator::Visibility visibility_;
};

/// Of each camera, the images that the largest part holds of those that markers tie together.
std::vector<std::size_t> tied_images(const World& world,
                                     const std::vector<ImageDetections>& images) {
  // Parts by their lowest image; a marker joins all that see it.
  std::vector<std::size_t> part(images.size());
  std::iota(part.begin(), part.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (part[i] != i) i = part[i] = part[part[i]];
    return i;
  };
  std::map<MarkerId, std::size_t> first;
  for (std::size_t i = 0; i < images.size(); ++i) {
    for (const Detection& detection : images[i].detections) {
      const auto [known, is_new] = first.emplace(detection.marker, i);
      if (!is_new) part[root(i)] = root(known->second);
    }
  }
  std::map<std::size_t, std::vector<std::size_t>> parts;
  for (std::size_t i = 0; i < images.size(); ++i) parts[root(i)].push_back(i);
  const auto largest = std::max_element(
      parts.begin(), parts.end(),
      [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  std::vector<std::size_t> tied(world.cameras(), 0);
  for (const std::size_t i : largest->second) ++tied[static_cast<std::size_t>(images[i].camera)];
  return tied;
}

}  // namespace

const char* name_of(RigKind kind) {
  constexpr std::array<const char*, 4> kNames = {"cg60", "cg120", "mono", "fisheye"};
  return kNames[static_cast<std::size_t>(kind)];
}

Rigid3 World::world_from_rig(double time_s) const {
  const double time = driving ? time_s : period_s * std::round(time_s / period_s);
  return way->world_from_cam0(start_m + speed_mps * time) *
         rig.cameras.front().rig_from_cam.inverse();
}

Rigid3 World::world_from_rig_at_set(std::size_t set) const {
  return world_from_rig(period_s * static_cast<double>(set));
}

World draw_world(RigKind kind, int scene, bool driving, Random& random) {
  World world;
  world.kind = kind;
  world.driving = driving;
  const char* scene_name = kScenes[static_cast<std::size_t>(scene) % kScenes.size()];
  world.name = fmt::format("{} {} {}", scene_name, name_of(kind), driving ? "driving" : "stills");
  auto loaded = simulator::load_scene(scene_name);
  WAYMARK_CHECK(loaded.has_value());
  world.scene = *std::move(loaded);
  world.rig = world.stated_rig = rig_of(kind, random);
  world.stated_catalog = world.scene.catalog;
  world.way = std::make_shared<const simulator::Trajectory>(world.scene.trajectory);
  const double length_m = world.way->length_m();
  world.start_m = random.uniform(0, length_m);
  world.speed_mps = world.scene.trajectory.speed_mps;
  constexpr std::size_t kStills = 36;
  constexpr std::size_t kDriven = 48;
  world.sets = driving ? kDriven : kStills;
  world.period_s = driving ? random.uniform(0.2, 0.5)
                           : length_m / (world.scene.trajectory.positions * world.speed_mps);
  world.noise_px = random.uniform(0.1, 0.3);
  world.with_covariances = random.uniform() < 0.5;
  world.seed = random.bits();
  for (std::size_t set = 0; set < world.sets; ++set) {
    const double time_s = world.period_s * static_cast<double>(set);
    world.exposed_s.emplace_back(world.cameras(), time_s);
    world.stamps.emplace_back(world.cameras(), kStart + to_stamp(time_s));
  }
  return world;
}

std::vector<ImageDetections> seen_images(const World& world) {
  const Onlooker onlooker(world);
  std::vector<ImageDetections> images;
  for (std::size_t set = 0; set < world.sets; ++set) {
    for (std::size_t camera = 0; camera < world.cameras(); ++camera) {
      images.push_back(onlooker.look(set, camera));
    }
  }
  return images;
}

bool is_well_seen(const World& world) {
  constexpr std::size_t kMarkers = 2;
  const std::vector<ImageDetections> images = seen_images(world);
  std::vector<std::size_t> seeing(world.cameras(), 0);
  std::vector<std::size_t> well(world.cameras(), 0);
  for (const ImageDetections& image : images) {
    const auto camera = static_cast<std::size_t>(image.camera);
    seeing[camera] += image.detections.empty() ? 0 : 1;
    well[camera] += image.detections.size() >= kMarkers ? 1 : 0;
  }
  const std::vector<std::size_t> tied = tied_images(world, images);
  for (std::size_t k = 0; k < world.cameras(); ++k) {
    if (2 * well[k] < world.sets || 10 * tied[k] < 9 * seeing[k]) return false;
  }
  return true;
}

std::vector<int> sights_of(const World& world, const std::vector<ImageDetections>& images) {
  std::map<MarkerId, int> sights;
  for (const ImageDetections& image : images) {
    for (const Detection& detection : image.detections) ++sights[detection.marker];
  }
  std::vector<int> by_marker;
  for (const auto& marker : world.scene.markers) by_marker.push_back(sights[marker.id]);
  return by_marker;
}

}  // namespace waymark::bench
