#include "mapbuilder/build/frame_comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.h"
#include "core/base/range.h"
#include "core/geometry/alignment.h"
#include "core/map/marker_search.h"

namespace waymark {
namespace {

struct CommonMarker {
  const MapMarker* now;
  const MapMarker* then;

  [[nodiscard]] const MarkerId& id() const { return now->id; }
};

/// More proposals would only repeat each other, at a cost of each against all markers.
constexpr std::size_t kMostProposals = 256;
/// A marker that moved by less than this many sigmas may have stayed.
constexpr double kSigmas = 5.0;

std::vector<CommonMarker> common_markers(const SubMap& map, const SubMap& old) {
  std::vector<CommonMarker> common;
  for (const MapMarker& marker : map.markers) {
    if (const MapMarker* then = find_marker(old, marker.id)) common.push_back({&marker, then});
  }
  return common;
}

std::vector<MarkerId> missing_in(const SubMap& in, const SubMap& from) {
  std::vector<MarkerId> missing;
  for (const MapMarker& marker : from.markers) {
    if (find_marker(in, marker.id) == nullptr) missing.push_back(marker.id);
  }
  return missing;
}

Eigen::Vector3d offset_m(const CommonMarker& marker, const Rigid3& old_from_new) {
  return old_from_new * marker.now->world_from_marker.translation -
         marker.then->world_from_marker.translation;
}

double turn_rad(const CommonMarker& marker, const Rigid3& old_from_new) {
  return angle_between_rad(old_from_new.rotation * marker.now->world_from_marker.rotation,
                           marker.then->world_from_marker.rotation);
}

bool covariances_known(const CommonMarker& marker) {
  return marker.now->covariance_known() && marker.then->covariance_known();
}

bool has_moved(const CommonMarker& marker, const Rigid3& old_from_new, const MovedLimits& limits) {
  const Vector6d variance = marker.now->covariance.diagonal() + marker.then->covariance.diagonal();
  const bool known = covariances_known(marker);
  const double sigma_m = known ? std::sqrt(variance.head<3>().maxCoeff()) : 0.0;
  const double sigma_rad = known ? std::sqrt(variance.tail<3>().maxCoeff()) : 0.0;
  return offset_m(marker, old_from_new).norm() > std::max(limits.distance_m, kSigmas * sigma_m) ||
         turn_rad(marker, old_from_new) > std::max(limits.turn_rad, kSigmas * sigma_rad);
}

ComparedMarker compared(const CommonMarker& marker, const Rigid3& old_from_new) {
  ComparedMarker result;
  result.id = marker.id();
  result.offset_m = offset_m(marker, old_from_new);
  result.distance_m = result.offset_m.norm();
  result.turn_rad = turn_rad(marker, old_from_new);
  if (!covariances_known(marker) || !(result.distance_m > 0)) return result;
  const Eigen::Vector3d along = result.offset_m / result.distance_m;
  const Eigen::Vector3d along_in_new = old_from_new.rotation.conjugate() * along;
  const double variance =
      along.dot(marker.then->covariance.topLeftCorner<3, 3>() * along) +
      along_in_new.dot(marker.now->covariance.topLeftCorner<3, 3>() * along_in_new);
  result.sigma_m = std::sqrt(std::max(0.0, variance));
  return result;
}

/// How badly a motion suits the markers; one that moved costs a bounded amount.
double misfit(const std::vector<CommonMarker>& common, const Rigid3& old_from_new,
              const MovedLimits& limits) {
  double sum = 0;
  for (const CommonMarker& marker : common) {
    sum += std::log1p(offset_m(marker, old_from_new).squaredNorm() /
                      (limits.distance_m * limits.distance_m));
  }
  return sum;
}

/// The motion that suits most, of those that single markers propose; evenly spread over them.
Rigid3 best_proposal(const std::vector<CommonMarker>& common, const MovedLimits& limits) {
  Rigid3 best;
  double least = std::numeric_limits<double>::infinity();
  const std::size_t proposals = std::min(common.size(), kMostProposals);
  for (std::size_t k = 0; k < proposals; ++k) {
    const CommonMarker& marker = common[k * common.size() / proposals];
    const Rigid3 proposed =
        marker.then->world_from_marker * marker.now->world_from_marker.inverse();
    const double cost = misfit(common, proposed, limits);
    if (cost < least) {
      least = cost;
      best = proposed;
    }
  }
  return best;
}

/// The motion that suits the given markers best.
std::optional<Rigid3> aligned(const std::vector<CommonMarker>& markers) {
  std::vector<Rigid3> now;
  std::vector<Rigid3> then;
  std::vector<Eigen::Vector3d> x_now;
  std::vector<Eigen::Vector3d> x_then;
  for (const CommonMarker& marker : markers) {
    now.push_back(marker.now->world_from_marker);
    then.push_back(marker.then->world_from_marker);
    x_now.push_back(now.back().translation);
    x_then.push_back(then.back().translation);
  }
  const auto motion = markers.size() < 3 || lie_on_a_line(x_now)
                          ? align_poses(now, then, false)
                          : align_points(x_now, x_then, false);
  if (!motion) return std::nullopt;
  return motion->motion;
}

/// A proposal refined over those that agree: one marker's turn swings far ones away, so these come
/// in step by step.
std::optional<Rigid3> refined(Rigid3 best, const std::vector<CommonMarker>& common,
                              const MovedLimits& limits, std::size_t fewest) {
  for (const double slack : {16.0, 8.0, 4.0, 2.0, 1.0, 1.0}) {
    const MovedLimits wide{slack * limits.distance_m, slack * limits.turn_rad};
    std::vector<CommonMarker> agreeing;
    for (const CommonMarker& marker : common) {
      if (!has_moved(marker, best, wide)) agreeing.push_back(marker);
    }
    if (agreeing.size() < fewest) return std::nullopt;
    const auto motion = aligned(agreeing);
    if (!motion) return std::nullopt;
    best = *motion;
  }
  return best;
}

}  // namespace

Status MovedLimits::check() const {
  return RangeCheck()
      .field("distance_m", distance_m, {0.001, 1})
      .field("turn_rad", turn_rad, {0.005, 0.5})
      .status();
}

std::optional<FrameComparison> compare_frames(const SubMap& map, const SubMap& old,
                                              const std::set<MarkerId>& suspects,
                                              const MovedLimits& limits, std::size_t fewest) {
  WAYMARK_CHECK(limits.check().has_value() && fewest >= 1);
  const std::vector<CommonMarker> all = common_markers(map, old);
  std::vector<CommonMarker> trusted;
  std::copy_if(all.begin(), all.end(), std::back_inserter(trusted),
               [&](const CommonMarker& marker) { return !suspects.contains(marker.id()); });
  if (trusted.size() < fewest) return std::nullopt;
  const auto motion = refined(best_proposal(trusted, limits), trusted, limits, fewest);
  if (!motion) return std::nullopt;

  FrameComparison comparison;
  comparison.old_from_new = *motion;
  for (const CommonMarker& marker : all) {
    const bool suspected = suspects.contains(marker.id());
    auto& verdict = has_moved(marker, *motion, limits) ? comparison.moved
                    : suspected                        ? comparison.suspects_in_place
                                                       : comparison.stayed;
    verdict.push_back(compared(marker, *motion));
  }
  comparison.appeared = missing_in(old, map);
  comparison.vanished = missing_in(map, old);
  return comparison;
}

}  // namespace waymark
