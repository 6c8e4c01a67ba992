#include "mapbuilder/report/plan_view.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/geometry/decompositions.h"
#include "mapbuilder/build/up_direction.h"

namespace waymark {
namespace {

std::vector<Eigen::Vector3d> normals_of(const SubMap& submap) {
  std::vector<Eigen::Vector3d> normals;
  for (const MapMarker& marker : submap.markers) {
    normals.emplace_back(marker.world_from_marker.rotation * Eigen::Vector3d::UnitZ());
  }
  return normals;
}

/// Angle (rad, modulo a right angle) of the walls on a plan; 0 without walls.
double wall_angle_rad(const std::vector<Eigen::Vector3d>& normals_in_plan) {
  std::complex<double> sum = 0;
  for (const Eigen::Vector3d& normal : normals_in_plan) {
    const std::complex<double> level(normal.x(), normal.y());
    const double length = std::abs(level);
    if (length > 0.5) sum += std::polar(length, 4 * std::arg(level));
  }
  return std::abs(sum) < 1e-9 ? 0.0 : std::arg(sum) / 4;
}

Eigen::Vector3d extent_m(const SubMap& submap, const Eigen::Quaterniond& plan_from_world) {
  Eigen::Vector3d lowest = plan_from_world * submap.markers.front().world_from_marker.translation;
  Eigen::Vector3d highest = lowest;
  for (const MapMarker& marker : submap.markers) {
    const Eigen::Vector3d centre = plan_from_world * marker.world_from_marker.translation;
    lowest = lowest.cwiseMin(centre);
    highest = highest.cwiseMax(centre);
  }
  return highest - lowest;
}

Eigen::Quaterniond turned_about_z(double angle_rad, const Eigen::Quaterniond& plan_from_world) {
  return Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()) * plan_from_world;
}

}  // namespace

PlanView plan_view(const SubMap& submap, const Eigen::Vector3d& camera_up_in_world) {
  PlanView view;
  view.z_is_up = submap.z_is_up;
  if (view.z_is_up || submap.markers.empty()) return view;
  std::vector<Eigen::Vector3d> normals = normals_of(submap);
  view.plan_from_world =
      shortest_rotation(guess_up(submap, camera_up_in_world), Eigen::Vector3d::UnitZ());
  for (Eigen::Vector3d& normal : normals) normal = view.plan_from_world * normal;
  view.plan_from_world = turned_about_z(-wall_angle_rad(normals), view.plan_from_world);
  const Eigen::Vector3d extent = extent_m(submap, view.plan_from_world);
  if (extent.y() > extent.x()) {
    view.plan_from_world = turned_about_z(std::numbers::pi / 2, view.plan_from_world);
  }
  return view;
}

}  // namespace waymark
