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

/// How surely the observations of one image place its camera against the map's markers; nullopt
/// where they don't. What is far off hardly counts.
std::optional<Matrix6d> information_of(const PreparedObservations& prepared,
                                       const std::map<MarkerIndex, Rigid3>& world_from_marker,
                                       FrameSetIndex image, const Rigid3& world_from_cam) {
  const Observations& observations = prepared.observations();
  PoseEquations equations;
  for (const ObservationIndex index : prepared.selection().used_in(image)) {
    const Observation& o = observations[index];
    const auto marker = world_from_marker.find(o.marker);
    if (marker == world_from_marker.end()) continue;
    const CameraPlace& place = observations.cameras[o.camera];
    const RigCamera& camera = observations.rigs[place.rig].cameras[place.in_rig];
    add_observation(prepared[index], {&camera.model, Rigid3{}, world_from_cam, marker->second},
                    ObservationLoss{Loss::tukey, 8.0}, FreePose::rig, equations);
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

CameraTracks tracks_of(const LocalizedImages& localized, const Rig& rig, Stamp sync_tolerance) {
  CameraTracks tracks;
  for (const RigCamera& camera : rig.cameras) {
    tracks.cameras.push_back(camera.name);
    tracks.lenses.push_back(camera.model);
  }
  const Observations& observations = localized.observations;
  std::map<MarkerIndex, Rigid3> world_from_marker;
  for (const MarkerIndex m : observations.markers.indices()) {
    for (const MapMarker& mapped : localized.map.markers) {
      if (mapped.id == observations.markers[m]) {
        world_from_marker.emplace(m, mapped.world_from_marker);
      }
    }
  }
  const Selection selection(observations);
  NoiseModel noise;
  noise.model_sigma_px = localized.model_sigma_px;
  const PreparedObservations prepared(selection, Estimate(selection, noise), 1);
  std::vector<StampedImage> images;
  std::vector<TrackedPlace> places;
  for (const LocalizedFrameSet& one : localized.trajectory) {
    const ObservedFrameSet& set = observations.frame_sets[one.frame_set];
    const auto information =
        information_of(prepared, world_from_marker, one.frame_set, one.world_from_rig);
    if (!information) continue;
    images.push_back({*set.mono_camera, set.stamp});
    places.push_back({one.world_from_rig, *information});
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
