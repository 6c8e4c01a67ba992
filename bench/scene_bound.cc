#include "bench/scene_bound.h"

#include <algorithm>
#include <map>

#include "core/geometry/tum.h"
#include "mapbuilder/bundle/prepared_observations.h"

namespace waymark::bench {
namespace {

/// Pose of a frame set's rig by a truth of poses of the whole rig; of its camera for mono.
Rigid3 pose_of_set(const SceneCapture& capture, const ObservedFrameSet& set,
                   const Rigid3& world_from_rig) {
  if (!capture.mono) return world_from_rig;
  const auto camera = static_cast<std::size_t>(set.mono_camera.value_or(0));
  return world_from_rig * capture.detected.rig.cameras[camera].rig_from_cam;
}

/// Collects what the first sub-map rests on, with poses from whatever source.
class GeometryMaker {
 public:
  explicit GeometryMaker(const SceneTrial& trial)
      : observations_(trial.observations),
        selection_(trial.observations),
        prepared_(selection_, trial.built.estimate, 1) {}

  void add_marker(const MapMarker& marker, const Rigid3& world_from_marker) {
    index_.emplace(marker.id, geometry.world_from_marker.size());
    geometry.world_from_marker.push_back(world_from_marker);
    geometry.sizes_m.push_back(marker.size_m);
  }

  /// `visit(observation, camera, seen)` fills in the whitening and says whether it counts.
  template <typename Visit>
  void add_frame_set(const LocalizedFrameSet& localized, const Rigid3& world_from_rig,
                     const Visit& visit) {
    const std::size_t before = geometry.observations.size();
    for (const ObservationIndex index : selection_.used_in(localized.frame_set)) {
      const Observation& o = observations_[index];
      const auto marker = index_.find(observations_.markers[o.marker]);
      if (marker == index_.end()) continue;
      const CameraPlace& place = observations_.cameras[o.camera];
      const RigCamera& camera = observations_.rigs[place.rig].cameras[place.in_rig];
      SceneObservation seen;
      seen.camera = &camera.model;
      seen.cam_from_rig = camera.rig_from_cam.inverse();
      seen.rig = geometry.world_from_rig.size();
      seen.marker = marker->second;
      const Rigid3 cam_from_marker =
          seen.cam_from_rig * (world_from_rig.inverse() * geometry.world_from_marker[seen.marker]);
      if (visit(prepared_[index], cam_from_marker, seen)) geometry.observations.push_back(seen);
    }
    if (geometry.observations.size() > before) geometry.world_from_rig.push_back(world_from_rig);
  }

  SceneGeometry geometry;

 private:
  const Observations& observations_;
  Selection selection_;
  PreparedObservations prepared_;
  std::map<MarkerId, std::size_t> index_;
};

Expected<SceneCovariance> covariance_of(const SceneGeometry& geometry) {
  auto covariance = SceneCovariance::of(geometry);
  if (!covariance) {
    return fail(ErrorKind::bad_data, "{} markers, {} rig poses: not fixed against each other",
                geometry.world_from_marker.size(), geometry.world_from_rig.size());
  }
  return *std::move(covariance);
}

}  // namespace

Expected<TrueScene> true_scene(const SceneCapture& capture, const SceneTrial& trial) {
  std::map<Stamp, Rigid3> world_from_rig;
  for (const StampedPose& pose : *capture.truth.world_from_rig) {
    world_from_rig[pose.stamp] = pose.pose;
  }
  TrueScene scene;
  GeometryMaker maker(trial);
  const BuiltSubMap& submap = trial.built.submaps.front();
  for (const MapMarker& marker : submap.map.markers) {
    const auto truth = capture.truth.world_from_marker->find(marker.id);
    if (truth != capture.truth.world_from_marker->end()) maker.add_marker(marker, truth->second);
  }
  for (const LocalizedFrameSet& localized : submap.trajectory) {
    const ObservedFrameSet& set = trial.observations.frame_sets[localized.frame_set];
    const auto at = world_from_rig.find(set.stamp);
    if (at == world_from_rig.end()) {
      return fail(ErrorKind::bad_data, "{}: no true pose at {} s", capture.scene,
                  format_stamp_s(set.stamp));
    }
    maker.add_frame_set(
        localized, pose_of_set(capture, set, at->second),
        [&](const MarkerObservation& o, const Rigid3& cam_from_marker, SceneObservation& seen) {
          seen.whitening.fill(Eigen::Matrix2d::Identity());
          const auto residuals = corner_residuals(o, *seen.camera, cam_from_marker);
          const auto misread = [](const Eigen::Vector2d& r) { return r.norm() > kMisread_px; };
          if (!residuals || std::any_of(residuals->begin(), residuals->end(), misread)) {
            ++scene.misread;
            return false;
          }
          CornerPair& pair = scene.corners.emplace_back();
          pair.found = o.corners_px;
          for (std::size_t i = 0; i < 4; ++i) pair.truth[i] = o.corners_px[i] - (*residuals)[i];
          return true;
        });
  }
  scene.geometry = std::move(maker.geometry);
  return scene;
}

Expected<SceneCovariance> bound_at_truth(const TrueScene& scene, double sigma_px) {
  SceneGeometry geometry = scene.geometry;
  for (SceneObservation& o : geometry.observations) {
    o.whitening.fill(Eigen::Matrix2d::Identity() / sigma_px);
  }
  return covariance_of(geometry);
}

Expected<SceneCovariance> joint_covariance(const SceneTrial& trial) {
  GeometryMaker maker(trial);
  const BuiltSubMap& submap = trial.built.submaps.front();
  for (const MapMarker& marker : submap.map.markers) {
    maker.add_marker(marker, marker.world_from_marker);
  }
  for (const LocalizedFrameSet& localized : submap.trajectory) {
    maker.add_frame_set(localized, localized.world_from_rig,
                        [](const MarkerObservation& o, const Rigid3&, SceneObservation& seen) {
                          seen.whitening = o.whitening;
                          return true;
                        });
  }
  return covariance_of(maker.geometry);
}

Expected<CornerVerdict> judge_corners(const SceneCapture& capture, const SceneTrial& trial) {
  const auto scene = true_scene(capture, trial);
  if (!scene) return tl::make_unexpected(scene.error());
  CornerVerdict verdict;
  verdict.observations = scene->corners.size();
  verdict.misread = scene->misread;
  verdict.corners = corner_accuracy(scene->corners);
  const auto bound = bound_at_truth(*scene, verdict.corners.sigma_px);
  if (!bound) return tl::make_unexpected(bound.error());
  std::vector<ImageCorners> bias;
  std::vector<ImageCorners> errors;
  for (const CornerPair& pair : scene->corners) {
    const ImageCorners moved = with_edges_moved(pair.truth, verdict.corners.edge_bias_px);
    ImageCorners& by_bias = bias.emplace_back();
    ImageCorners& error = errors.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) {
      by_bias[i] = moved[i] - pair.truth[i];
      error[i] = pair.found[i] - pair.truth[i];
    }
  }
  verdict.bound = bound->expected();
  verdict.by_bias = bound->response(bias);
  verdict.by_corners = bound->response(errors);
  return verdict;
}

}  // namespace waymark::bench
