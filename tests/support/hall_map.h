#pragma once

#include <cmath>
#include <random>

#include "core/map/marker_map.h"

namespace waymark::test {

/// A hall's two walls with `count` markers, 1 mm sure each; seeded noise a little smaller.
inline SubMap hall(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.0007);
  SubMap map;
  for (int i = 0; i < count; ++i) {
    MapMarker marker;
    marker.id = {Family::tag36h11, i};
    marker.stated_size_m = marker.size_m = 0.16;
    marker.verified = true;
    const double along = 1.3 * i;
    const bool left = i % 2 == 0;
    marker.world_from_marker = {so3_exp(Eigen::Vector3d(0, 0, left ? 0.0 : M_PI)) *
                                    so3_exp(Eigen::Vector3d(M_PI / 2, 0, 0)),
                                {along + noise(random), (left ? 4.0 : -4.0) + noise(random),
                                 1.0 + 0.3 * (i % 3) + noise(random)}};
    marker.covariance = 1e-6 * Matrix6d::Identity();
    map.markers.push_back(marker);
  }
  return map;
}

/// The same in another world.
inline SubMap seen_from(SubMap map, const Rigid3& new_from_old) {
  for (MapMarker& marker : map.markers) {
    marker.world_from_marker = new_from_old * marker.world_from_marker;
  }
  return map;
}

}  // namespace waymark::test
