#include "mapbuilder/diagnosis/camera_tracks.h"

#include <Eigen/Cholesky>
#include <map>

#include "core/base/parallel.h"
#include "core/capture/frame_set.h"
#include "mapbuilder/bundle/prepared_observations.h"

namespace waymark {
namespace {

/// What a place is not known better than, however many markers it rests on: the map itself is an
/// estimate. Standard deviations of the place (m, rad).
constexpr double kFloor_m = 0.0005;
constexpr double kFloor_rad = 0.00017;

Matrix6d floor_covariance() {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kFloor_m), Eigen::Vector3d::Constant(kFloor_rad);
  return sigma.cwiseAbs2().asDiagonal();
}

/// How surely the accepted observations of one image place its camera against the map's markers;
/// nullopt where they don't.
std::optional<Matrix6d> information_of(const PreparedObservations& prepared,
                                       const BuildResult& result,
                                       const std::map<MarkerIndex, Rigid3>& world_from_marker,
                                       FrameSetIndex image, const Rigid3& world_from_cam) {
  const Observations& observations = prepared.observations();
  PoseEquations equations;
  for (const ObservationIndex index : prepared.selection().used_in(image)) {
    const Observation& o = observations[index];
    const auto marker = world_from_marker.find(o.marker);
    if (marker == world_from_marker.end() || !result.estimate.accepts(index)) continue;
    const RigCamera& camera = result.estimate.calibration.camera(observations, o);
    add_observation(prepared[index], {&camera.model, Rigid3{}, world_from_cam, marker->second},
                    ObservationLoss{}, FreePose::rig, equations);
  }
  if (equations.corners < 4) return std::nullopt;
  const Eigen::LDLT<Matrix6d> factor(equations.hessian);
  if (!factor.isPositive() || factor.rcond() < 1e-14) return std::nullopt;
  const Matrix6d covariance = factor.solve(Matrix6d::Identity()) + floor_covariance();
  const Matrix6d information = covariance.ldlt().solve(Matrix6d::Identity());
  if (!information.allFinite()) return std::nullopt;
  return 0.5 * (information + information.transpose());
}

}  // namespace

CameraTracks tracks_of(const Observations& mono, const BuildResult& result, CaptureIndex capture,
                       const Rig& rig, Stamp sync_tolerance) {
  CameraTracks tracks;
  for (const RigCamera& camera : rig.cameras) {
    tracks.cameras.push_back(camera.name);
    tracks.lenses.push_back(camera.model);
  }
  if (result.submaps.empty()) return tracks;
  const BuiltSubMap& submap = result.submaps.front();
  std::map<MarkerIndex, Rigid3> world_from_marker;
  for (const MarkerIndex m : mono.markers.indices()) {
    for (const MapMarker& mapped : submap.map.markers) {
      if (mapped.id == mono.markers[m]) world_from_marker.emplace(m, mapped.world_from_marker);
    }
  }
  const Selection selection(mono);
  const PreparedObservations prepared(selection, result.estimate, 1);
  std::vector<StampedImage> images;
  std::vector<TrackedPlace> places;
  for (const LocalizedFrameSet& localized : submap.trajectory) {
    const ObservedFrameSet& set = mono.frame_sets[localized.frame_set];
    if (set.capture != capture || !set.mono_camera) continue;
    const auto information = information_of(prepared, result, world_from_marker,
                                            localized.frame_set, localized.world_from_rig);
    if (!information) continue;
    images.push_back({*set.mono_camera, set.stamp});
    places.push_back({localized.world_from_rig, *information});
  }
  for (const FrameSet& set : group_into_frame_sets(images, sync_tolerance)) {
    CameraTracks::Instant instant;
    instant.stamp = set.stamp;
    instant.places.resize(rig.cameras.size());
    for (const std::size_t i : set.images) {
      instant.places[static_cast<std::size_t>(images[i].camera)] = places[i];
    }
    tracks.instants.push_back(std::move(instant));
  }
  return tracks;
}

}  // namespace waymark
