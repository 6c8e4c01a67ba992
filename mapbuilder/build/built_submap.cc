#include "mapbuilder/build/built_submap.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "mapbuilder/bundle/marker_covariances.h"
#include "mapbuilder/calibration/scale_bound.h"

namespace waymark {
namespace {

/// Sums of squared corner residuals over observations.
struct ResidualSum {
  double squared_px2 = 0;
  std::size_t corners = 0;
  /// A corner counts as `most_px` off at most: near the camera plane a wrong id's is as far off as
  /// one likes, and says nothing more.
  void add(const std::array<Eigen::Vector2d, 4>& residuals, double most_px) {
    for (const Eigen::Vector2d& r : residuals) {
      squared_px2 += std::min(r.squaredNorm(), most_px * most_px);
    }
    corners += 4;
  }
  [[nodiscard]] double rms_px() const {
    return corners == 0 ? 0.0 : std::sqrt(squared_px2 / static_cast<double>(corners));
  }
};

/// Of the part's localized frame sets and mapped markers.
std::vector<std::size_t> posed_observations(const JointBuild& build, const Component& part) {
  const ObservationTable& table = build.table();
  std::vector<std::size_t> observations;
  for (const int frame_set : part.frame_sets) {
    const TableFrameSet& set = table.frame_sets[static_cast<std::size_t>(frame_set)];
    for (std::size_t i = 0; i < set.observation_count; ++i) {
      const std::size_t index = set.first_observation + i;
      if (build.state().posed(table.observations[index])) observations.push_back(index);
    }
  }
  return observations;
}

/// The grown components that the part has markers of.
std::vector<const ComponentGrowth*> growths_of(const JointBuild& build, const Component& part) {
  std::vector<const ComponentGrowth*> growths;
  for (const ComponentGrowth* growth : build.parts()) {
    const auto& markers = growth->component().markers;
    if (std::any_of(part.markers.begin(), part.markers.end(), [&](int marker) {
          return std::binary_search(markers.begin(), markers.end(), marker);
        })) {
      growths.push_back(growth);
    }
  }
  return growths;
}

/// What the part's own information rests on: a piece that the gate has cut off stands in no world
/// but its own.
AdjustmentScope scope_of(const JointBuild& build, bool in_facility) {
  AdjustmentScope scope = build.scope();
  if (!in_facility) scope.world_of_marker.clear();
  return scope;
}

}  // namespace

bool stands_in_facility(const JointBuild& build, const Component& part) {
  const AdjustmentScope& scope = build.scope();
  return scope.survey != nullptr && scope.in_facility(part.markers.front()) &&
         reach_of(*scope.survey, build.table(), poses_of(part, build.state())).frame;
}

BuiltSubMap describe(const JointBuild& build, const Component& part) {
  const ObservationTable& table = build.table();
  const MapState& state = build.state();
  const BuildOptions& options = build.options();
  BuiltSubMap result;
  result.settled = true;
  for (const ComponentGrowth* growth : growths_of(build, part)) {
    result.model_sigma_px = std::max(result.model_sigma_px, growth->noise().model_sigma_px);
    result.settled = result.settled && growth->settled();
  }
  const std::vector<std::size_t> observations = posed_observations(build, part);
  result.observations = observations.size();

  std::map<int, int> accepted_in_set;
  for (const std::size_t index : observations) {
    accepted_in_set[table.observations[index].frame_set] += state.accepted[index];
  }

  ResidualSum inliers;
  ResidualSum all;
  std::vector<ResidualSum> per_marker(table.markers.size());
  std::vector<std::uint32_t> rejected(table.markers.size(), 0);
  std::vector<std::uint32_t> accepted(table.markers.size(), 0);
  // Views by rigs that other markers place as well: only these can contradict a marker's place.
  std::vector<std::uint32_t> independent(table.markers.size(), 0);
  for (const std::size_t index : observations) {
    const TableObservation& o = table.observations[index];
    const auto marker = static_cast<std::size_t>(o.marker);
    const auto residuals =
        corner_residuals(o, camera_of(table, o).model, cam_from_marker(table, state, o));
    const double most_px = gross_residual_px(camera_of(table, o).model);
    if (residuals) {
      all.add(*residuals, most_px);
      result.residuals.push_back({index, state.accepted[index] != 0, *residuals});
    }
    if (state.accepted[index] == 0 || !residuals) {
      ++rejected[marker];
      ++result.rejected;
      continue;
    }
    ++accepted[marker];
    independent[marker] += accepted_in_set[o.frame_set] >= 2 ? 1 : 0;
    inliers.add(*residuals, most_px);
    per_marker[marker].add(*residuals, most_px);
  }
  result.map.rms_px = inliers.rms_px();
  result.map.rms_all_px = all.rms_px();

  const bool in_facility = stands_in_facility(build, part);
  const AdjustmentScope scope = scope_of(build, in_facility);
  const auto seed = static_cast<std::size_t>(choose_seed(table, part));
  const Rigid3 world_from_built = in_facility ? Rigid3{} : state.rigs[seed]->best.pose.inverse();
  const MarkerPoses poses = poses_of(part, state);
  if (in_facility) {
    result.map.frame = FrameKind::facility;
    result.map.z_is_up = true;
  } else if (scope.survey != nullptr && reach_of(*scope.survey, table, poses).scale) {
    result.map.frame = FrameKind::scaled;
  }
  if (result.map.frame == FrameKind::arbitrary) {
    result.scale_per_edge_px = scale_per_edge_px(build, observations, static_cast<int>(seed));
  }
  result.survey = survey_residuals(options.survey, table, poses, in_facility);
  for (const int frame_set : part.frame_sets) {
    const RigPoseEstimate& rig = *state.rigs[static_cast<std::size_t>(frame_set)];
    if (rig.ambiguous) {
      result.ambiguous.push_back(frame_set);
    } else {
      result.trajectory.push_back({frame_set, world_from_built * rig.best.pose});
    }
  }
  result.map.frame_sets = static_cast<std::uint32_t>(result.trajectory.size());

  const MarkerInformation information =
      marker_information(table, observations, options.loss, scope, build.threads(), state);
  const std::vector<Matrix6d> covariances = marker_covariances(information);
  result.covariances_known = !covariances.empty();
  const Matrix6d turn = left_motion_jacobian(world_from_built);
  for (const int index : part.markers) {
    const auto m = static_cast<std::size_t>(index);
    MapMarker marker;
    marker.id = table.markers[m];
    marker.stated_size_m = table.stated_sizes_m[m];
    marker.size_m = table.sizes_m[m];
    marker.world_from_marker = world_from_built * *state.world_from_marker[m];
    marker.observations = accepted[m];
    marker.rejected = rejected[m];
    marker.rms_px = per_marker[m].rms_px();
    marker.verified = independent[m] >= 2;
    const auto slot =
        std::lower_bound(information.markers.begin(), information.markers.end(), index);
    marker.covariance = unknown_covariance();
    if (!covariances.empty() && slot != information.markers.end() && *slot == index) {
      const Matrix6d& covariance =
          covariances[static_cast<std::size_t>(slot - information.markers.begin())];
      const Matrix6d turned = turn * covariance * turn.transpose();
      marker.covariance = 0.5 * (turned + turned.transpose());
    }
    result.map.markers.push_back(marker);
  }
  return result;
}

}  // namespace waymark
