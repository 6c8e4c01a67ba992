#include "simulator/camera_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace waymark::simulator {
namespace {

/// Light from a plate that is smaller than this (px) is lost in the wall's texture.
constexpr double kLeastPlate_px = 3.0;

struct Bounds {
  double left = std::numeric_limits<double>::infinity();
  double right = -std::numeric_limits<double>::infinity();
  double top = std::numeric_limits<double>::infinity();
  double bottom = -std::numeric_limits<double>::infinity();

  void add(const Eigen::Vector2d& pixel) {
    left = std::min(left, pixel.x());
    right = std::max(right, pixel.x());
    top = std::min(top, pixel.y());
    bottom = std::max(bottom, pixel.y());
  }
};

/// Adds the plate's outline; corners and points between, because lenses bend it. False when a point
/// lies outside the lens's domain: then nothing is known of the plate's reach.
bool add_outline(const CameraModel& camera, const Rigid3& cam_from_marker, double half_m,
                 Bounds& bounds) {
  constexpr int kPerEdge = 4;
  bool all_inside = true;
  for (int i = 0; i < kPerEdge; ++i) {
    const double along = half_m * (2.0 * i / kPerEdge - 1.0);
    for (const Eigen::Vector3d& point :
         {Eigen::Vector3d(along, half_m, 0), Eigen::Vector3d(half_m, -along, 0),
          Eigen::Vector3d(-along, -half_m, 0), Eigen::Vector3d(-half_m, along, 0)}) {
      const auto pixel = camera.project(cam_from_marker * point);
      if (pixel) bounds.add(*pixel);
      all_inside = all_inside && pixel.has_value();
    }
  }
  return all_inside;
}

std::optional<PlateInView> plate_in_view(const Renderer::Stage& stage, const CameraModel& camera,
                                         std::size_t index, const Rigid3& first,
                                         const Rigid3& last) {
  const PlacedMarker& marker = stage.scene->markers[index];
  const int side_cells = stage.prints[index].side_cells();
  const double cell_m = marker.size_m / stage.prints[index].square_cells();
  const double half_m = 0.5 * cell_m * side_cells;
  PlateInView plate{};
  plate.plane = {static_cast<int>(index), PlaneMap::of(marker.world_from_marker, first, cell_m),
                 PlaneMap::of(marker.world_from_marker, last, cell_m)};
  if (plate.plane.first.eye_height <= 0 || plate.plane.last.eye_height <= 0) return std::nullopt;
  Bounds bounds;
  bool known = true;
  for (const Rigid3& world_from_cam : {first, last}) {
    known &=
        add_outline(camera, world_from_cam.inverse() * marker.world_from_marker, half_m, bounds);
  }
  const CameraParameters& p = camera.parameters();
  if (!(bounds.left <= bounds.right)) return std::nullopt;
  if (!known)
    bounds = {0.0, static_cast<double>(p.width_px), 0.0, static_cast<double>(p.height_px)};
  if (std::max(bounds.right - bounds.left, bounds.bottom - bounds.top) < kLeastPlate_px) {
    return std::nullopt;
  }
  constexpr double kMargin_px = 2;
  const auto clamp_px = [](double value, int size) {
    return static_cast<int>(std::clamp(value, -64.0, size + 64.0));
  };
  plate.left_px = clamp_px(std::floor(bounds.left - kMargin_px), p.width_px);
  plate.right_px = clamp_px(std::ceil(bounds.right + kMargin_px), p.width_px);
  plate.top_px = clamp_px(std::floor(bounds.top - kMargin_px), p.height_px);
  plate.bottom_px = clamp_px(std::ceil(bounds.bottom + kMargin_px), p.height_px);
  const bool reaches_image = plate.right_px > -64 && plate.left_px < p.width_px + 64 &&
                             plate.bottom_px > -64 && plate.top_px < p.height_px + 64;
  return reaches_image ? std::optional(plate) : std::nullopt;
}

}  // namespace

CameraView view_of(const Renderer::Stage& stage, const CameraModel& camera,
                   const Rigid3& world_from_cam_first, const Rigid3& world_from_cam_last) {
  CameraView view;
  for (std::size_t i = 0; i < stage.world_from_surface.size(); ++i) {
    const MovingPlane plane{static_cast<int>(i),
                            PlaneMap::of(stage.world_from_surface[i], world_from_cam_first, 1.0),
                            PlaneMap::of(stage.world_from_surface[i], world_from_cam_last, 1.0)};
    if (plane.first.eye_height > 0 && plane.last.eye_height > 0) view.surfaces.push_back(plane);
  }
  for (std::size_t i = 0; i < stage.scene->markers.size(); ++i) {
    if (const auto plate =
            plate_in_view(stage, camera, i, world_from_cam_first, world_from_cam_last)) {
      view.plates.push_back(*plate);
    }
  }
  return view;
}

}  // namespace waymark::simulator
