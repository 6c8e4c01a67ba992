#include "locd/pose/protection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/so3.h"

namespace waymark {
namespace {

/// Markers, at least, that a pose must rest on when something is wrong.
constexpr int kFewestMarkers = 2;

}  // namespace

ProtectionLevels::ProtectionLevels(std::size_t cameras, const Eigen::Vector3d& point_in_rig,
                                   bool guessed)
    : cameras_(cameras), point_in_rig_(point_in_rig), inflation_(guessed ? kGuessed : 1) {
  left_out_.reserve(kMaxObservations);
}

Matrix6d ProtectionLevels::by_rig(const Rigid3& world_from_rig) const {
  // p = t + R a: δp = δt + δφ × R a.
  Matrix6d by = Matrix6d::Identity();
  by.topRightCorner<3, 3>() = -skew(world_from_rig.rotation * point_in_rig_);
  return by;
}

/// Of one hypothesis, for the pose that is used lies `apart` from the one that knows nothing of it.
void ProtectionLevels::raise(const Vector6d& apart, const Matrix6d& covariance,
                             Protection& levels) const {
  /// Of a length that `away` has and whose error is so spread. Levels are the largest of many:
  /// what can't exceed by its longest axis, which is quickly told, is not asked further.
  const auto raise_to = [&]<int N>(double& level, double away,
                                   const Eigen::Matrix<double, N, N>& spread) {
    const double most = away + inflation_ * std::sqrt(spread.trace()) * risk_.chi[N - 1];
    if (most <= level) return;
    const double sum = away + inflation_ * gaussian_bound<N>(spread, risk_);
    level = std::isfinite(sum) ? std::max(level, sum) : std::numeric_limits<double>::infinity();
  };
  for (int i = 0; i < 3; ++i) {
    raise_to(levels.axis_m[i], std::abs(apart[i]), Eigen::Matrix<double, 1, 1>(covariance(i, i)));
  }
  raise_to(levels.horizontal_m, apart.head<2>().norm(),
           Eigen::Matrix2d(covariance.topLeftCorner<2, 2>()));
  raise_to(levels.rotation_rad, apart.tail<3>().norm(),
           Eigen::Matrix3d(covariance.bottomRightCorner<3, 3>()));
}

/// The hypothesis that all observations of which `wrong` holds are.
template <typename Wrong>
void ProtectionLevels::suspect(std::span<const SetObservation> observations,
                               const PoseSolution& solution, RobustPose& robust, const Wrong& wrong,
                               Protection& levels) {
  left_out_.clear();
  int markers_left = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!robust.considered()[i].used) continue;
    if (wrong(observations[i])) {
      left_out_.push_back(i);
      continue;
    }
    const bool before =
        std::any_of(observations.begin(), observations.begin() + static_cast<std::ptrdiff_t>(i),
                    [&](const SetObservation& o) {
                      const auto at = static_cast<std::size_t>(&o - observations.data());
                      return robust.considered()[at].used && !wrong(o) &&
                             o.map_index == observations[i].map_index;
                    });
    markers_left += before ? 0 : 1;
  }
  if (left_out_.empty()) return;
  ConsiderPose& pose = robust.consider();
  const auto rest = markers_left < kFewestMarkers ? std::nullopt : pose.without(left_out_);
  if (!rest) {
    levels = Protection::none(levels.of_cameras);
    return;
  }
  const Matrix6d by = by_rig(solution.world_from_rig);
  // What an older map may be wrong by in common holds whoever is left out.
  const Matrix6d shared = solution.covariance - pose.covariance();
  raise(by * (pose.step() - rest->step), by * (rest->covariance + shared) * by.transpose(), levels);
}

Protection ProtectionLevels::of(std::span<const SetObservation> observations,
                                const PoseSolution& solution, RobustPose& robust) {
  Protection levels{Eigen::Vector3d::Zero(), 0, 0, cameras_ > 1};
  if (solution.ambiguous || solution.rivals) return Protection::none(levels.of_cameras);
  const Matrix6d by = by_rig(solution.world_from_rig);
  raise(Vector6d::Zero(), by * solution.covariance * by.transpose(), levels);
  for (std::size_t i = 0; i < observations.size() && levels.finite(); ++i) {
    const std::size_t marker = observations[i].map_index;
    const auto same = [&](const SetObservation& o) { return o.map_index == marker; };
    const auto here = observations.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::any_of(observations.begin(), here, same)) continue;
    suspect(observations, solution, robust, same, levels);
  }
  for (std::size_t c = 0; c < cameras_ && cameras_ > 1 && levels.finite(); ++c) {
    suspect(
        observations, solution, robust,
        [&](const SetObservation& o) { return o.observation.camera == static_cast<int>(c); },
        levels);
  }
  return levels;
}

}  // namespace waymark
