#include "simulator/visibility.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace waymark::simulator {
namespace {

/// Side of the floor squares by which markers are looked up.
constexpr double kSquare_m = 5.0;

std::uint64_t square_key(int x, int y) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32U) |
         static_cast<std::uint32_t>(y);
}

int square_of(double metres) { return static_cast<int>(std::floor(metres / kSquare_m)); }

}  // namespace

Visibility::Visibility(const Scene& scene, const VisibilityLimits& limits)
    : scene_(scene), limits_(limits) {
  for (std::size_t i = 0; i < scene.markers.size(); ++i) {
    const Eigen::Vector3d& at = scene.markers[i].world_from_marker.translation;
    markers_by_square_[square_key(square_of(at.x()), square_of(at.y()))].push_back(i);
    largest_marker_m_ = std::max(largest_marker_m_, scene.markers[i].size_m);
  }
}

std::vector<VisibleMarker> Visibility::visible_from(const CameraModel& camera,
                                                    const Rigid3& world_from_cam) const {
  const CameraParameters& p = camera.parameters();
  const double range_m =
      1.5 * largest_marker_m_ * std::max(p.fu_px, p.fv_px) / limits_.least_side_px;
  const Eigen::Vector3d& eye = world_from_cam.translation;
  const Occluders occluders = occluders_near(scene_, eye, range_m);
  std::vector<VisibleMarker> visible;
  for (int x = square_of(eye.x() - range_m); x <= square_of(eye.x() + range_m); ++x) {
    for (int y = square_of(eye.y() - range_m); y <= square_of(eye.y() + range_m); ++y) {
      const auto square = markers_by_square_.find(square_key(x, y));
      if (square == markers_by_square_.end()) continue;
      for (const std::size_t i : square->second) {
        VisibleMarker seen{i, {}};
        if (sees(camera, world_from_cam, occluders, scene_.markers[i], seen.corners))
          visible.push_back(seen);
      }
    }
  }
  std::sort(visible.begin(), visible.end(),
            [](const VisibleMarker& a, const VisibleMarker& b) { return a.marker < b.marker; });
  return visible;
}

bool Visibility::sees(const CameraModel& camera, const Rigid3& world_from_cam,
                      const Occluders& occluders, const PlacedMarker& marker,
                      ImageCorners& corners) const {
  const Eigen::Vector3d& eye = world_from_cam.translation;
  const Eigen::Vector3d& centre = marker.world_from_marker.translation;
  const Eigen::Vector3d to_eye = eye - centre;
  const Eigen::Vector3d normal = marker.world_from_marker.rotation * Eigen::Vector3d::UnitZ();
  const double least_cosine = std::cos(limits_.most_obliquity_deg * std::numbers::pi / 180.0);
  if (normal.dot(to_eye) < least_cosine * to_eye.norm()) return false;

  const CameraParameters& p = camera.parameters();
  const Rigid3 cam_from_world = world_from_cam.inverse();
  const Rigid3 cam_from_marker = cam_from_world * marker.world_from_marker;
  const auto in_marker = marker_corners(marker.size_m);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = camera.project(cam_from_marker * in_marker[i]);
    if (!pixel || pixel->x() < limits_.border_px || pixel->y() < limits_.border_px ||
        pixel->x() > p.width_px - 1 - limits_.border_px ||
        pixel->y() > p.height_px - 1 - limits_.border_px) {
      return false;
    }
    corners[i] = *pixel;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    if ((corners[i] - corners[(i + 1) % 4]).norm() < limits_.least_side_px) return false;
  }
  if (is_occluded(occluders, eye, centre)) return false;
  return std::none_of(in_marker.begin(), in_marker.end(), [&](const Eigen::Vector3d& corner) {
    return is_occluded(occluders, eye, marker.world_from_marker * corner);
  });
}

}  // namespace waymark::simulator
