#pragma once

#include <algorithm>
#include <numbers>
#include <random>

#include "mapbuilder/build/map_builder.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark::test {

/// A room as a build would have mapped it, half a millimetre and a fiftieth of a degree off in a
/// world of its own, with what somebody measures in it.
class MeasuredRoom {
 public:
  static constexpr double kMap_m = 0.0005;
  static constexpr double kMap_rad = 0.00035;

  explicit MeasuredRoom(std::uint32_t seed) : room(room_of(seed)), random_(seed) {
    observations = observations_of(room);
    const Selection selection(observations);
    result.estimate = true_estimate(room, selection);
    const Rigid3 world_from_room{
        Eigen::Quaterniond(Eigen::AngleAxisd(0.7 * seed, Eigen::Vector3d(1, 2, 3).normalized())),
        {0.3 * seed, -2, 1}};
    BuiltSubMap submap;
    for (std::size_t m = 0; m < room.world_from_marker.size(); ++m) {
      MapMarker marker;
      marker.id = {Family::tag36h11, static_cast<int>(m)};
      marker.size_m = marker.stated_size_m = 0.3;
      marker.verified = true;
      marker.world_from_marker = (world_from_room * room.world_from_marker[m]).plus(noise());
      marker.covariance.diagonal() << Eigen::Vector3d::Constant(kMap_m * kMap_m),
          Eigen::Vector3d::Constant(kMap_rad * kMap_rad);
      submap.map.markers.push_back(marker);
    }
    for (const FrameSetIndex f : observations.frame_sets.indices()) {
      submap.trajectory.push_back({f, world_from_room * room.world_from_rig[f.value()]});
    }
    result.submaps.push_back(submap);
    result.map.submaps.push_back(submap.map);
  }

  /// Different numbers of markers.
  std::vector<int> some_markers(std::size_t count) {
    std::vector<int> numbers(room.world_from_marker.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<int>(i);
    std::shuffle(numbers.begin(), numbers.end(), random_);
    numbers.resize(count);
    std::sort(numbers.begin(), numbers.end());
    return numbers;
  }

  /// Where a marker's centre, or a spot of it, is measured to be, in the room's frame.
  Eigen::Vector3d measured(int number, double sigma_m,
                           const Eigen::Vector3d& x_in_marker = Eigen::Vector3d::Zero()) {
    return room.world_from_marker[static_cast<std::size_t>(number)] * x_in_marker +
           sigma_m * Eigen::Vector3d(normal_(random_), normal_(random_), normal_(random_));
  }

  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }

  SyntheticRoom room;
  Observations observations;
  BuildResult result;

 private:
  static SyntheticRoom room_of(std::uint32_t seed) {
    RoomOptions options;
    options.markers = 30;
    options.frame_sets = 12;
    options.seed = seed;
    return make_room(options);
  }

  Vector6d noise() {
    Vector6d delta;
    for (int i = 0; i < 3; ++i) {
      delta[i] = kMap_m * normal_(random_);
      delta[i + 3] = kMap_rad * normal_(random_);
    }
    return delta;
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

}  // namespace waymark::test
