#include "mapbuilder/build/up_direction.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

using Eigen::Vector3d;
using Directions = SymmetricEigen<3>;

/// Cameras that look all ways say nothing about up below this mean length.
constexpr double kTellingCameraUp = 0.3;

std::vector<Vector3d> normals_of(const SubMap& submap) {
  std::vector<Vector3d> normals;
  for (const MapMarker& marker : submap.markers) {
    normals.emplace_back(marker.world_from_marker.rotation * Vector3d::UnitZ());
  }
  return normals;
}

Eigen::Matrix3d scatter_of(const std::vector<Vector3d>& normals) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Vector3d& normal : normals) scatter += normal * normal.transpose();
  return scatter;
}

bool is_level(const Vector3d& normal, const Vector3d& up) {
  constexpr double kWall = 0.5;  // of the normal's upward part: within 30° of level
  return std::abs(normal.dot(up)) < kWall;
}

/// Up by the normals: level ones belong to walls and stand across it, steep ones to floors and lie
/// along it. `guess` decides what a single wall leaves open.
Vector3d refine_up(const std::vector<Vector3d>& normals, const Vector3d& guess) {
  constexpr int kRounds = 10;
  constexpr double kFloor = 0.87;  // within 30° of upright
  Vector3d up = guess;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d scatter =
        -1e-4 * static_cast<double>(normals.size()) * guess * guess.transpose();
    for (const Vector3d& normal : normals) {
      if (is_level(normal, up)) scatter += normal * normal.transpose();
      if (std::abs(normal.dot(up)) > kFloor) scatter -= normal * normal.transpose();
    }
    const Vector3d better = symmetric_eigen<3>(scatter).vectors.col(0);
    up = better.dot(up) < 0 ? Vector3d(-better) : better;
  }
  return up;
}

/// Without a hint from the cameras: normals that all lie along one axis are a floor's, for cameras
/// that look at walls stay upright; others are walls'.
Vector3d guess_up_by_normals(const std::vector<Vector3d>& normals) {
  constexpr double kOneAxis = 0.8;  // share of the squared normals
  const Eigen::Matrix3d scatter = scatter_of(normals);
  const Directions directions = symmetric_eigen<3>(scatter);
  const bool floor = directions.values[2] > kOneAxis * scatter.trace();
  const Vector3d up = refine_up(normals, directions.vectors.col(floor ? 2 : 0));
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& normal : normals) sum += normal;
  return sum.dot(up) < 0 ? Vector3d(-up) : up;
}

/// Mean of the normals within 20° of a direction, and how many these are.
struct Bundle {
  std::size_t count = 0;
  Vector3d mean = Vector3d::Zero();
};

constexpr double kAlike = 0.94;

/// Normals that point alike, each by its first one's neighbourhood. A building has few directions.
std::vector<Bundle> bundles_of(const std::vector<Vector3d>& normals) {
  std::vector<Bundle> bundles;
  for (const Vector3d& first : normals) {
    const bool known = std::any_of(bundles.begin(), bundles.end(), [&](const Bundle& bundle) {
      return bundle.mean.dot(first) > kAlike;
    });
    if (known) continue;
    Bundle bundle;
    for (const Vector3d& normal : normals) {
      if (normal.dot(first) < kAlike) continue;
      ++bundle.count;
      bundle.mean += normal;
    }
    bundle.mean.normalize();
    bundles.push_back(bundle);
  }
  return bundles;
}

/// The bundle of a floor where cameras don't tell: that of most normals, if it holds half of them.
const Bundle* largest(const std::vector<Bundle>& bundles, std::size_t normals) {
  const auto most =
      std::max_element(bundles.begin(), bundles.end(),
                       [](const Bundle& a, const Bundle& b) { return a.count < b.count; });
  return most != bundles.end() && 2 * most->count >= normals ? &*most : nullptr;
}

/// That which points most clearly along the cameras' up; nullptr where none does, or two alike.
const Bundle* nearest(const std::vector<Bundle>& bundles, const Vector3d& camera_up) {
  constexpr double kSteep = 0.5;  // cosine
  constexpr double kClearly = 0.1;
  const Bundle* best = nullptr;
  double next = kSteep;
  for (const Bundle& bundle : bundles) {
    if (bundle.count < 2) continue;
    const double along = bundle.mean.dot(camera_up);
    const double so_far = best == nullptr ? kSteep : best->mean.dot(camera_up);
    next = std::max(next, std::min(along, so_far));
    if (along > so_far) best = &bundle;
  }
  if (best == nullptr || (next > kSteep && best->mean.dot(camera_up) < next + kClearly)) {
    return nullptr;
  }
  return best;
}

/// Across all normals that are level for `guess`; nullopt where they face along one line.
std::optional<Vector3d> across_walls(const std::vector<Vector3d>& normals, const Vector3d& guess) {
  constexpr double kTells = 0.02;  // of all normals' squares: 8° of spread
  std::vector<Vector3d> walls;
  for (const Vector3d& normal : normals) {
    if (is_level(normal, guess)) walls.push_back(normal);
  }
  if (walls.size() < 2) return std::nullopt;
  const Directions directions = symmetric_eigen<3>(scatter_of(walls));
  if (directions.values[1] < kTells * directions.values.sum()) return std::nullopt;
  return directions.vectors.col(0);
}

}  // namespace

std::optional<Vector3d> up_by_floor(const SubMap& submap, const Vector3d& camera_up) {
  const std::vector<Vector3d> normals = normals_of(submap);
  const std::vector<Bundle> bundles = bundles_of(normals);
  const bool telling = camera_up.norm() >= kTellingCameraUp;
  const Bundle* floor =
      telling ? nearest(bundles, camera_up.normalized()) : largest(bundles, normals.size());
  if (floor == nullptr || floor->count < 2) return std::nullopt;
  return floor->mean;
}

std::optional<Vector3d> up_by_walls(const SubMap& submap, const Vector3d& camera_up) {
  constexpr double kUpright = 0.5;  // cosine: cameras lean by 60° at most
  if (camera_up.norm() < kTellingCameraUp) return std::nullopt;
  const std::vector<Vector3d> normals = normals_of(submap);
  const std::vector<Bundle> bundles = bundles_of(normals);
  // Every two directions of walls propose an up; the cameras' own choose among them.
  std::optional<Vector3d> best;
  double most_upright = kUpright;
  for (std::size_t i = 0; i < bundles.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vector3d across = bundles[i].mean.cross(bundles[j].mean);
      if (across.norm() < std::sqrt(1 - kAlike * kAlike)) continue;
      const auto up = across_walls(normals, across.normalized());
      if (!up) continue;
      const double upright = up->dot(camera_up.normalized());
      if (std::abs(upright) <= most_upright) continue;
      most_upright = std::abs(upright);
      best = upright < 0 ? Vector3d(-*up) : *up;
    }
  }
  return best;
}

Vector3d guess_up(const SubMap& submap, const Vector3d& camera_up) {
  const std::vector<Vector3d> normals = normals_of(submap);
  return camera_up.norm() >= kTellingCameraUp ? refine_up(normals, camera_up.normalized())
                                              : guess_up_by_normals(normals);
}

}  // namespace waymark
