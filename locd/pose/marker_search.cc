#include "locd/pose/marker_search.h"

#include <algorithm>

#include "core/base/check.h"

namespace waymark {

MarkerSearch::MarkerSearch(const Rig& rig, const MarkerCatalog& catalog,
                           const LocalizerOptions& options)
    : rig_(rig),
      detector_(rig_, catalog, options.detection_threads, options.begin_worker),
      health_(rig.cameras.size(), options.image_health()) {
  WAYMARK_CHECK(options.check().has_value());
  WAYMARK_CHECK(rig.cameras.size() <= kMaxCameras);
  alerts_.reserve(kMaxObservations);
}

void MarkerSearch::search(const FrameSetLease& set, std::span<const MarkerId> ignored,
                          PoseEstimate& estimate) {
  alerts_.clear();
  estimate.reset(PoseReason::no_map, set);
  usable_ = health_.look(set, alerts_);
  detector_.detect(set, usable_);
  detection_watch_.look(detector_.searched(), detector_.failed(), estimate.stamp, alerts_);
  for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
    for (const Detection& detection : detector_.detections_of(camera)) {
      if (estimate.observations.size() == kMaxObservations) return;
      const auto& before = estimate.observations;
      const bool known = std::any_of(before.begin(), before.end(), [&](const ObservedMarker& o) {
        return o.marker == detection.marker;
      });
      estimate.markers_seen += known ? 0 : 1;
      ObservedMarker& seen = estimate.observations.emplace_back();
      seen.marker = detection.marker;
      seen.camera = static_cast<std::int16_t>(camera);
      seen.corners_px = detection.corners;
      seen.covariances = detection.covariances;
      if (std::binary_search(ignored.begin(), ignored.end(), detection.marker)) {
        seen.verdict = ObservationVerdict::ignored;
      }
    }
  }
}

}  // namespace waymark
