#include "simulator/occlusion.h"

#include <algorithm>

namespace waymark::simulator {
namespace {

/// A marker hangs on its box: a ray that only touches a face is not cut off.
constexpr double kTouch = 1e-6;

bool box_cuts(const Box& box, const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
  double enter = 0.0;
  double leave = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (way[axis] == 0.0) {
      if (from[axis] <= box.min_m[axis] || from[axis] >= box.max_m[axis]) return false;
      continue;
    }
    const double a = (box.min_m[axis] - from[axis]) / way[axis];
    const double b = (box.max_m[axis] - from[axis]) / way[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
    if (enter + kTouch >= leave) return false;
  }
  return true;
}

bool wall_cuts(const Surface& wall, const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
  const Eigen::Vector3d normal = wall.normal();
  const double toward = normal.dot(way);
  if (toward == 0.0) return false;
  const double t = normal.dot(wall.origin - from) / toward;
  if (t <= kTouch || t >= 1.0 - kTouch) return false;
  const Eigen::Vector3d hit = from + t * way - wall.origin;
  const double across = hit.dot(wall.right);
  const double above = hit.dot(wall.up);
  return across > 0 && across < wall.width_m && above > 0 && above < wall.height_m;
}

double distance_to_box(const Box& box, const Eigen::Vector3d& p) {
  const Eigen::Vector3d beyond = (box.min_m - p).cwiseMax(p - box.max_m);
  const double inside = beyond.maxCoeff();
  return inside < 0 ? inside : beyond.cwiseMax(0.0).norm();
}

double distance_to_wall(const Surface& wall, const Eigen::Vector3d& p) {
  const Eigen::Vector3d from = p - wall.origin;
  const double across = std::clamp(from.dot(wall.right), 0.0, wall.width_m);
  const double above = std::clamp(from.dot(wall.up), 0.0, wall.height_m);
  return (p - wall.point(across, above)).norm();
}

}  // namespace

Occluders occluders_near(const Scene& scene, const Eigen::Vector3d& point_m, double range_m) {
  Occluders near;
  const auto reaches = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    return low.x() <= point_m.x() + range_m && high.x() >= point_m.x() - range_m &&
           low.y() <= point_m.y() + range_m && high.y() >= point_m.y() - range_m;
  };
  for (const Box& box : scene.boxes) {
    if (reaches(box.min_m, box.max_m)) near.boxes.push_back(&box);
  }
  for (const Surface& wall : scene.walls) {
    const Eigen::Vector3d far = wall.point(wall.width_m, wall.height_m);
    if (reaches(wall.origin.cwiseMin(far), wall.origin.cwiseMax(far))) near.walls.push_back(&wall);
  }
  return near;
}

bool is_occluded(const Occluders& occluders, const Eigen::Vector3d& from_m,
                 const Eigen::Vector3d& to_m) {
  const Eigen::Vector3d way = to_m - from_m;
  return std::any_of(occluders.boxes.begin(), occluders.boxes.end(),
                     [&](const Box* box) { return box_cuts(*box, from_m, way); }) ||
         std::any_of(occluders.walls.begin(), occluders.walls.end(),
                     [&](const Surface* wall) { return wall_cuts(*wall, from_m, way); });
}

double clearance_m(const Scene& scene, const Eigen::Vector3d& point_m) {
  double nearest = std::min(point_m.minCoeff(), (scene.room_size_m - point_m).minCoeff());
  for (const Box& box : scene.boxes) nearest = std::min(nearest, distance_to_box(box, point_m));
  for (const Surface& wall : scene.walls)
    nearest = std::min(nearest, distance_to_wall(wall, point_m));
  return nearest;
}

}  // namespace waymark::simulator
