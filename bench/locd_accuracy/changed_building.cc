#include "bench/locd_accuracy/changed_building.h"

namespace waymark::bench {

void move_marker(simulator::Scene& building, std::size_t marker, double distance_m, double turn_rad,
                 simulator::Random& random) {
  Rigid3& pose = building.markers[marker].world_from_marker;
  const Eigen::Vector3d normal = pose.rotation * Eigen::Vector3d::UnitZ();
  Eigen::Vector3d direction(random.normal(), random.normal(), random.normal());
  direction.normalize();
  if (direction.dot(normal) < 0) direction -= 2 * direction.dot(normal) * normal;  // not into walls
  pose.translation += distance_m * direction;
  Eigen::Vector3d axis(random.normal(), random.normal(), random.normal());
  pose.rotation = (so3_exp(turn_rad * axis.normalized()) * pose.rotation).normalized();
}

}  // namespace waymark::bench
