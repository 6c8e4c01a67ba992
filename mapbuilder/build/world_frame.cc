#include "mapbuilder/build/world_frame.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/check.h"
#include "core/base/range.h"
#include "core/geometry/alignment.h"
#include "core/geometry/decompositions.h"
#include "mapbuilder/build/up_direction.h"

namespace waymark {
namespace {

struct CommonMarker {
  const MapMarker* now;
  const MapMarker* then;
};

std::vector<CommonMarker> common_markers(const SubMap& map, const SubMap& old) {
  std::map<MarkerId, const MapMarker*> then;
  for (const MapMarker& marker : old.markers) then.emplace(marker.id, &marker);
  std::vector<CommonMarker> common;
  for (const MapMarker& marker : map.markers) {
    const auto known = then.find(marker.id);
    if (known != then.end()) common.push_back({&marker, known->second});
  }
  return common;
}

double distance_m(const CommonMarker& marker, const Rigid3& old_from_new) {
  return (old_from_new * marker.now->world_from_marker.translation -
          marker.then->world_from_marker.translation)
      .norm();
}

double turn_rad(const CommonMarker& marker, const Rigid3& old_from_new) {
  return angle_between_rad(old_from_new.rotation * marker.now->world_from_marker.rotation,
                           marker.then->world_from_marker.rotation);
}

bool has_moved(const CommonMarker& marker, const Rigid3& old_from_new, const MovedLimits& limits) {
  constexpr double kSigmas = 5.0;
  const Vector6d variance = marker.now->covariance.diagonal() + marker.then->covariance.diagonal();
  const bool known = marker.now->covariance_known() && marker.then->covariance_known();
  const double sigma_m = known ? std::sqrt(variance.head<3>().maxCoeff()) : 0.0;
  const double sigma_rad = known ? std::sqrt(variance.tail<3>().maxCoeff()) : 0.0;
  return distance_m(marker, old_from_new) > std::max(limits.distance_m, kSigmas * sigma_m) ||
         turn_rad(marker, old_from_new) > std::max(limits.turn_rad, kSigmas * sigma_rad);
}

/// How badly a motion suits the markers; one that moved costs a bounded amount.
double misfit(const std::vector<CommonMarker>& common, const Rigid3& old_from_new,
              const MovedLimits& limits) {
  double sum = 0;
  for (const CommonMarker& marker : common) {
    const double d = distance_m(marker, old_from_new) / limits.distance_m;
    sum += std::log1p(d * d);
  }
  return sum;
}

}  // namespace

Status MovedLimits::check() const {
  return RangeCheck()
      .field("distance_m", distance_m, {0.001, 1})
      .field("turn_rad", turn_rad, {0.005, 0.5})
      .status();
}

Eigen::Vector3d camera_up_in_world(const BuiltSubMap& submap, const Observations& observations,
                                   const Calibration& calibration) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0;
  for (const LocalizedFrameSet& localized : submap.trajectory) {
    const RigIndex rig = observations.frame_sets[localized.frame_set].rig;
    for (const RigCamera& camera : calibration.rigs[rig].cameras) {
      sum -= localized.world_from_rig.rotation *
             (camera.rig_from_cam.rotation * Eigen::Vector3d::UnitY());
      count += 1;
    }
  }
  return count == 0 ? sum : Eigen::Vector3d(sum / count);
}

void move_world(BuiltSubMap& submap, const Rigid3& new_from_old) {
  const Matrix6d turn = left_motion_jacobian(new_from_old);
  for (MapMarker& marker : submap.map.markers) {
    marker.world_from_marker = new_from_old * marker.world_from_marker;
    const Matrix6d turned = turn * marker.covariance * turn.transpose();
    marker.covariance = 0.5 * (turned + turned.transpose());
  }
  for (LocalizedFrameSet& set : submap.trajectory) {
    set.world_from_rig = new_from_old * set.world_from_rig;
  }
}

std::optional<Rigid3> level_world(const BuiltSubMap& submap, LevelBy by,
                                  const Eigen::Vector3d& camera_up_in_world) {
  const auto up = by == LevelBy::floor ? up_by_floor(submap.map, camera_up_in_world)
                                       : up_by_walls(submap.map, camera_up_in_world);
  if (!up) return std::nullopt;
  return Rigid3{shortest_rotation(*up, Eigen::Vector3d::UnitZ()), {0, 0, 0}};
}

std::optional<FrameComparison> compare_frames(const SubMap& map, const SubMap& old,
                                              const std::set<MarkerId>& suspects,
                                              const MovedLimits& limits) {
  WAYMARK_CHECK(limits.check().has_value());
  std::vector<CommonMarker> common = common_markers(map, old);
  const auto trusted_end = std::stable_partition(
      common.begin(), common.end(),
      [&](const CommonMarker& marker) { return !suspects.contains(marker.now->id); });
  const std::vector<CommonMarker> suspected(trusted_end, common.end());
  common.erase(trusted_end, common.end());
  if (common.size() < 3) return std::nullopt;
  Rigid3 best;
  double least = std::numeric_limits<double>::infinity();
  for (const CommonMarker& marker : common) {
    const Rigid3 proposed =
        marker.then->world_from_marker * marker.now->world_from_marker.inverse();
    const double cost = misfit(common, proposed, limits);
    if (cost < least) {
      least = cost;
      best = proposed;
    }
  }
  // One marker's turn swings far ones away: let the agreeing ones in step by step.
  std::vector<CommonMarker> unmoved;
  for (double slack : {16.0, 8.0, 4.0, 2.0, 1.0, 1.0}) {
    unmoved.clear();
    std::vector<Rigid3> now;
    std::vector<Rigid3> then;
    std::vector<Eigen::Vector3d> x_now;
    std::vector<Eigen::Vector3d> x_then;
    for (const CommonMarker& marker : common) {
      const MovedLimits wide{slack * limits.distance_m, slack * limits.turn_rad};
      if (has_moved(marker, best, wide)) continue;
      unmoved.push_back(marker);
      now.push_back(marker.now->world_from_marker);
      then.push_back(marker.then->world_from_marker);
      x_now.push_back(now.back().translation);
      x_then.push_back(then.back().translation);
    }
    if (unmoved.size() < 3) return std::nullopt;
    const auto aligned =
        lie_on_a_line(x_now) ? align_poses(now, then, false) : align_points(x_now, x_then, false);
    if (!aligned) return std::nullopt;
    best = aligned->motion;
  }

  FrameComparison comparison;
  comparison.old_from_new = best;
  comparison.unmoved = unmoved.size();
  const auto compared = [&](const CommonMarker& marker) {
    return MovedMarker{marker.now->id, distance_m(marker, best), turn_rad(marker, best)};
  };
  for (const CommonMarker& marker : common) {
    if (has_moved(marker, best, limits)) comparison.moved.push_back(compared(marker));
  }
  for (const CommonMarker& marker : suspected) {
    auto& verdict =
        has_moved(marker, best, limits) ? comparison.moved : comparison.suspects_in_place;
    verdict.push_back(compared(marker));
  }
  std::sort(comparison.moved.begin(), comparison.moved.end(),
            [](const MovedMarker& a, const MovedMarker& b) { return a.id < b.id; });
  const auto missing_in = [](const SubMap& from, const SubMap& in) {
    std::vector<MarkerId> missing;
    for (const MapMarker& marker : from.markers) {
      const auto same = [&](const MapMarker& other) { return other.id == marker.id; };
      if (std::none_of(in.markers.begin(), in.markers.end(), same)) missing.push_back(marker.id);
    }
    return missing;
  };
  comparison.appeared = missing_in(map, old);
  comparison.vanished = missing_in(old, map);
  return comparison;
}

}  // namespace waymark
