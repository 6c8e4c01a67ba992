#include "mapbuilder/report/report_of_build.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/check.h"
#include "mapbuilder/build/world_frame.h"
#include "mapbuilder/evaluate/trajectory.h"

namespace waymark {
namespace {

/// The report's cameras: those that are alike (name and intrinsics) are one.
class CameraList {
 public:
  explicit CameraList(std::vector<ReportCamera>& cameras) : cameras_(cameras) {}

  std::size_t index_of(const RigCamera& camera, const std::string& capture) {
    for (std::size_t i = 0; i < known_.size(); ++i) {
      if (known_[i]->name == camera.name &&
          known_[i]->model.parameters() == camera.model.parameters()) {
        return i;
      }
    }
    const bool name_taken = std::any_of(known_.begin(), known_.end(), [&](const RigCamera* other) {
      return other->name == camera.name;
    });
    const CameraParameters& p = camera.model.parameters();
    cameras_.push_back({name_taken ? camera.name + " of " + capture : camera.name,
                        p.width_px,
                        p.height_px,
                        {p.pu_px, p.pv_px}});
    known_.push_back(&camera);
    return cameras_.size() - 1;
  }

 private:
  std::vector<ReportCamera>& cameras_;
  std::vector<const RigCamera*> known_;
};

void add_observations(const BuildResult& result, const Observations& observations, Report& report) {
  CameraList cameras(report.cameras);
  for (const BuiltSubMap& submap : result.submaps) {
    for (const ObservationResidual& residual : submap.residuals) {
      const Observation& o = observations[residual.observation];
      const Calibration& calibration = result.estimate.calibration;
      const CaptureIndex capture = observations.frame_sets[o.frame_set].capture;
      report.observations.push_back({observations.markers[o.marker],
                                     cameras.index_of(calibration.camera(observations, o),
                                                      observations.captures[capture].name),
                                     residual.accepted, corrected_corners(o, calibration),
                                     residual.corners_px});
    }
  }
}

std::vector<ReportTrack> tracks_of(const BuiltSubMap& submap, const Observations& observations) {
  std::map<std::pair<CaptureIndex, std::optional<int>>, ReportTrack>
      tracks;  // by capture and camera
  for (const LocalizedFrameSet& localized : submap.trajectory) {
    const ObservedFrameSet& set = observations.frame_sets[localized.frame_set];
    ReportTrack& track = tracks[{set.capture, set.mono_camera}];
    track.capture = observations.captures[set.capture].name;
    if (set.mono_camera) track.camera = fmt::format("cam{}", *set.mono_camera);
    track.poses.push_back({set.stamp, localized.world_from_rig});
  }
  std::vector<ReportTrack> sorted;
  for (auto& [key, track] : tracks) {
    std::stable_sort(track.poses.begin(), track.poses.end(),
                     [](const StampedPose& a, const StampedPose& b) { return a.stamp < b.stamp; });
    sorted.push_back(std::move(track));
  }
  return sorted;
}

/// The true poses of what a track follows, carried by `map_from_truth`.
std::vector<StampedPose> true_poses(const ReportTrack& track, const CaptureTruth& truth,
                                    const Rigid3& map_from_truth) {
  Rigid3 rig_from_tracked;
  if (track.camera) {
    const auto camera =
        std::find_if(truth.rig.cameras.begin(), truth.rig.cameras.end(),
                     [&](const RigCamera& candidate) { return candidate.name == *track.camera; });
    WAYMARK_CHECK(camera != truth.rig.cameras.end());
    rig_from_tracked = camera->rig_from_cam;
  }
  std::vector<StampedPose> poses;
  for (const StampedPose& pose : truth.world_from_rig) {
    poses.push_back({pose.stamp, map_from_truth * pose.pose * rig_from_tracked});
  }
  return poses;
}

/// Lays a capture's truth beside its tracks; stays away where no pose has a true one.
void add_truth(const CaptureTruth& truth, std::vector<ReportTrack>& tracks) {
  std::vector<Trajectory> estimated;
  for (const ReportTrack& track : tracks) {
    if (track.capture == truth.capture) estimated.push_back({track.camera, track.poses});
  }
  if (estimated.empty()) return;
  const auto matched = match_with_truth(estimated, truth.world_from_rig, &truth.rig);
  WAYMARK_CHECK(matched.has_value());  // the cameras are the rig's own
  const auto accuracy = accuracy_of_cameras(matched->pairs);
  if (!accuracy) return;
  const Rigid3 map_from_truth = accuracy->truth_from_estimate.inverse();
  for (ReportTrack& track : tracks) {
    if (track.capture != truth.capture) continue;
    track.true_poses = true_poses(track, truth, map_from_truth);
    track.rmse_to_true = accuracy->rmse;
  }
}

}  // namespace

Report report_of_build(const BuildResult& result, const Observations& observations,
                       const std::vector<CaptureTruth>& truths) {
  Report report;
  report.map = result.map;
  for (const ObservedCapture& capture : observations.captures) {
    report.captures.push_back({capture.name, capture.fingerprint});
  }
  for (const BuiltSubMap& submap : result.submaps) {
    ReportSubMap told;
    told.tracks = tracks_of(submap, observations);
    for (const CaptureTruth& truth : truths) add_truth(truth, told.tracks);
    told.observations = submap.observations;
    told.rejected = submap.rejected;
    told.ambiguous = submap.ambiguous.size();
    told.corner_sigma_px = submap.model_sigma_px;
    told.covariances_known = submap.covariances_known;
    if (submap.scale) told.scale_sigma = submap.scale->sigma;
    told.camera_up_in_world = camera_up_in_world(submap, observations, result.estimate.calibration);
    report.submaps.push_back(std::move(told));
  }
  add_observations(result, observations, report);
  report.unmapped = result.unmapped;
  report.unlocalized = result.unlocalized.size();
  report.without_markers = result.without_markers.size();
  return report;
}

}  // namespace waymark
