#pragma once

#include <span>
#include <vector>

#include "core/camera/rig.h"
#include "core/marker/marker_catalog.h"
#include "locd/alert.h"
#include "locd/frames/frame_synchronizer.h"
#include "locd/frames/image_health.h"
#include "locd/pose/detection_watch.h"
#include "locd/pose/frame_detector.h"
#include "locd/pose/localizer_options.h"
#include "locd/pose/pose_estimate.h"

namespace waymark {

/// Where there is no map yet: looks whether images are of use and which markers are in them, so
/// that a recording for the first map is not made blind. One thread calls it.
class MarkerSearch {
 public:
  /// Finds the markers of `catalog` (none: looks at the images only). Copies what it needs; the
  /// options are valid (checked).
  MarkerSearch(const Rig& rig, const MarkerCatalog& catalog, const LocalizerOptions& options);

  /// LOST for want of a map, with what was found as observations that are unused, or of a marker
  /// that `ignored` (by rising id) holds. Of more than kMaxObservations the first.
  void search(const FrameSetLease& set, std::span<const MarkerId> ignored, PoseEstimate& estimate);

  /// What began or ended with the last set.
  [[nodiscard]] std::span<const Alert> alerts() const { return alerts_; }
  /// Cameras whose images can't be used now: frozen, stale, dark, saturated, obscured.
  [[nodiscard]] CameraMask unhealthy() const { return health_.unhealthy(); }

 private:
  Rig rig_;
  FrameDetector detector_;
  ImageHealth health_;
  DetectionWatch detection_watch_;
  CameraMask usable_ = 0;
  std::vector<Alert> alerts_;
};

}  // namespace waymark
