#include "locd/pose/set_observer.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace waymark {

SetObserver::SetObserver(const Rig& rig, const MapIndex& map, const LocalizerOptions& options)
    : rig_(rig),
      map_(map),
      guided_(options.guided),
      detector_(rig, map.catalog(options.inverted), options.detection_threads,
                options.begin_worker),
      expected_(rig, map),
      health_(rig.cameras.size(), options.image_health()) {
  candidates_.reserve(2 * kMaxObservations);
  used_.reserve(kMaxObservations);
  others_.reserve(kMaxObservations);
  all_.reserve(kMaxObservations);
  ignored_.reserve(kMostIgnored);
}

void SetObserver::look(const FrameSetLease& set, const std::optional<MotionPrediction>& predicted,
                       PoseEstimate& estimate, std::vector<Alert>& alerts) {
  usable_ = health_.look(set, alerts);
  find_markers(set, predicted);
  detection_watch_.look(detector_.searched(), detector_.failed(), estimate.stamp, alerts);
  unhealthy_frames_ = set.cameras & ~usable_;
  usable_ &= ~detector_.failed();
  find_candidates(set);
  used_.clear();
  others_.clear();
  for (const Candidate& candidate : candidates_) observe(candidate, estimate);
  const auto& seen = estimate.observations;
  for (auto one = seen.begin(); one != seen.end(); ++one) {
    const bool before = std::any_of(seen.begin(), one, [&](const ObservedMarker& other) {
      return other.marker == one->marker;
    });
    estimate.markers_seen += before ? 0 : 1;
  }
}

void SetObserver::find_markers(const FrameSetLease& set,
                               const std::optional<MotionPrediction>& predicted) {
  if (guided_) expected_.predict(predicted);
  detector_.detect(set, usable_, expected_.by_camera());
  for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
    if ((detector_.searched() & camera_bit(c)) != 0) {
      expected_.remember(c, detector_.detections_of(c));
    }
  }
}

/// The detections that are used, by camera: of more than kMaxObservations, the largest in the
/// image.
void SetObserver::find_candidates(const FrameSetLease& set) {
  candidates_.clear();
  for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
    if (!set.has(camera)) continue;
    const auto detections = detector_.detections_of(camera);
    for (std::size_t i = 0; i < detections.size(); ++i) {
      candidates_.push_back({camera, i, area_px2(detections[i].corners)});
    }
  }
  if (candidates_.size() <= kMaxObservations) return;
  const auto end = candidates_.begin() + kMaxObservations;
  std::nth_element(
      candidates_.begin(), end, candidates_.end(), [](const Candidate& a, const Candidate& b) {
        return std::tie(b.area_px2, a.camera, a.index) < std::tie(a.area_px2, b.camera, b.index);
      });
  candidates_.erase(end, candidates_.end());
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.camera, a.index) < std::tie(b.camera, b.index);
  });
}

/// With what is known of its marker.
void SetObserver::observe(const Candidate& candidate, PoseEstimate& estimate) {
  const std::size_t camera = candidate.camera;
  const auto of_camera = detector_.detections_of(camera);
  const Detection& detection = of_camera[candidate.index];
  ObservedMarker seen;
  seen.marker = detection.marker;
  seen.camera = static_cast<std::int16_t>(camera);
  seen.corners_px = detection.corners;
  seen.covariances = detection.covariances;
  const auto same_id = [&](const Detection& other) { return other.marker == detection.marker; };
  const auto map_index = map_.find(detection.marker);
  if (std::binary_search(ignored_.begin(), ignored_.end(), detection.marker)) {
    seen.verdict = ObservationVerdict::ignored;
  } else if (!map_index) {
    seen.verdict = ObservationVerdict::unknown;
  } else if (!rig_.cameras[camera].model.covers_all(detection.corners)) {
    seen.verdict = ObservationVerdict::beyond;
  } else if (std::count_if(of_camera.begin(), of_camera.end(), same_id) > 1) {
    seen.verdict = ObservationVerdict::repeated;
  } else {
    const bool use = !map_.quarantined(*map_index);
    if (!use) seen.verdict = ObservationVerdict::quarantined;
    SetObservation& o = (use ? used_ : others_).emplace_back();
    o.observation.camera = static_cast<int>(camera);
    o.observation.size_m = map_.marker(*map_index).size_m;
    o.detected_px = detection.corners;
    if (detection.covariances) {
      o.stated = *detection.covariances;
    } else {
      o.stated.fill(Eigen::Matrix2d::Zero());
    }
    o.map_index = *map_index;
    o.report_index = estimate.observations.size();
  }
  estimate.observations.push_back(seen);
}

void SetObserver::leave_out(CameraMask suspects, PoseEstimate& estimate) {
  constexpr std::size_t kEnough = 2;
  if (suspects == 0) return;
  const auto is_suspect = [&](const SetObservation& o) {
    return (suspects & camera_bit(static_cast<std::size_t>(o.observation.camera))) != 0;
  };
  const auto suspect = std::count_if(used_.begin(), used_.end(), is_suspect);
  if (used_.size() - static_cast<std::size_t>(suspect) < kEnough) return;
  for (const SetObservation& o : used_) {
    if (!is_suspect(o)) continue;
    estimate.observations[o.report_index].verdict = ObservationVerdict::quarantined;
    others_.push_back(o);
  }
  std::erase_if(used_, is_suspect);
}

void SetObserver::time_corners(const FrameSetLease& set, PoseEstimate& estimate) {
  CameraMask seeing = 0;
  for (const SetObservation& o : used_) {
    seeing |= camera_bit(static_cast<std::size_t>(o.observation.camera));
  }
  if (seeing != 0) {
    Stamp sum{0};
    int count = 0;
    for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
      if ((seeing & camera_bit(c)) == 0) continue;
      sum += set.frames[c].stamp() - estimate.set_stamp;
      ++count;
    }
    estimate.stamp = estimate.set_stamp + sum / count;
  }
  for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
    if (set.has(c)) estimate.camera_offset[c] = set.frames[c].stamp() - estimate.stamp;
  }
  const auto time = [&](SetObservation& o) {
    const RigCamera& camera = rig_.cameras[static_cast<std::size_t>(o.observation.camera)];
    const double offset_s =
        in_s(estimate.camera_offset[static_cast<std::size_t>(o.observation.camera)]);
    const double readout_s = camera.readout_us.value_or(0) * 1e-6;
    const double rows = camera.model.parameters().height_px;
    for (std::size_t i = 0; i < 4; ++i) {
      // The stamp is of the middle row, (rows − 1)/2.
      o.row[i] = (o.detected_px[i].y() - 0.5 * (rows - 1)) / rows;
      o.after_s[i] = offset_s + readout_s * o.row[i];
    }
  };
  std::for_each(used_.begin(), used_.end(), time);
  std::for_each(others_.begin(), others_.end(), time);
}

std::span<const SetObservation> SetObserver::all() {
  all_.assign(used_.begin(), used_.end());
  all_.insert(all_.end(), others_.begin(), others_.end());
  return all_;
}

}  // namespace waymark
