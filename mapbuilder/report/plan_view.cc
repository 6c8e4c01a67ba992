#include "mapbuilder/report/plan_view.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

/// Cameras that look all ways say nothing about up below this mean length.
constexpr double kTellingCameraUp = 0.3;

std::vector<Eigen::Vector3d> normals_of(const SubMap& submap) {
  std::vector<Eigen::Vector3d> normals;
  for (const MapMarker& marker : submap.markers) {
    normals.push_back(marker.world_from_marker.rotation * Eigen::Vector3d::UnitZ());
  }
  return normals;
}

/// Up by the normals: level ones belong to walls and stand across it, steep ones to floors and lie
/// along it. `guess` decides what a single wall leaves open.
Eigen::Vector3d refine_up(const std::vector<Eigen::Vector3d>& normals,
                          const Eigen::Vector3d& guess) {
  constexpr int kRounds = 10;
  constexpr double kWall = 0.5;    // of the normal's upward part: within 30° of level
  constexpr double kFloor = 0.87;  // within 30° of upright
  Eigen::Vector3d up = guess;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d scatter =
        -1e-4 * static_cast<double>(normals.size()) * guess * guess.transpose();
    for (const Eigen::Vector3d& normal : normals) {
      const double upward = std::abs(normal.dot(up));
      if (upward < kWall) scatter += normal * normal.transpose();
      if (upward > kFloor) scatter -= normal * normal.transpose();
    }
    const Eigen::Vector3d better = symmetric_eigen<3>(scatter).vectors.col(0);
    up = better.dot(up) < 0 ? Eigen::Vector3d(-better) : better;
  }
  return up;
}

/// Without a hint from the cameras: normals that all lie along one axis are a floor's, for cameras
/// that look at walls stay upright; others are walls'.
Eigen::Vector3d find_up_by_normals(const std::vector<Eigen::Vector3d>& normals) {
  constexpr double kOneAxis = 0.8;  // share of the squared normals
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& normal : normals) {
    scatter += normal * normal.transpose();
    sum += normal;
  }
  const SymmetricEigen<3> directions = symmetric_eigen<3>(scatter);
  const bool floor = directions.values[2] > kOneAxis * scatter.trace();
  const Eigen::Vector3d up = refine_up(normals, directions.vectors.col(floor ? 2 : 0));
  return sum.dot(up) < 0 ? Eigen::Vector3d(-up) : up;
}

Eigen::Vector3d find_up(const std::vector<Eigen::Vector3d>& normals,
                        const Eigen::Vector3d& camera_up) {
  const bool telling = camera_up.norm() >= kTellingCameraUp;
  return telling ? refine_up(normals, camera_up.normalized()) : find_up_by_normals(normals);
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
      shortest_rotation(find_up(normals, camera_up_in_world), Eigen::Vector3d::UnitZ());
  for (Eigen::Vector3d& normal : normals) normal = view.plan_from_world * normal;
  view.plan_from_world = turned_about_z(-wall_angle_rad(normals), view.plan_from_world);
  const Eigen::Vector3d extent = extent_m(submap, view.plan_from_world);
  if (extent.y() > extent.x()) {
    view.plan_from_world = turned_about_z(std::numbers::pi / 2, view.plan_from_world);
  }
  return view;
}

}  // namespace waymark
