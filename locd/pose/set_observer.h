#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/camera/rig.h"
#include "locd/alert.h"
#include "locd/frames/frame_synchronizer.h"
#include "locd/frames/image_health.h"
#include "locd/pose/detection_watch.h"
#include "locd/pose/expected_windows.h"
#include "locd/pose/frame_detector.h"
#include "locd/pose/localizer_options.h"
#include "locd/pose/map_index.h"
#include "locd/pose/pose_estimate.h"
#include "locd/pose/set_observation.h"

namespace waymark {

/// What a frame set shows of the map: finds markers in the images that are of use, and says of each
/// mapped one where and when its corners were seen. Watches images and searches meanwhile.
class SetObserver {
 public:
  /// Rig and map must outlive it. Holds its memory.
  SetObserver(const Rig& rig, const MapIndex& map, const LocalizerOptions& options);

  /// Looks at a set; `predicted` tells where markers are expected. Writes all detections into
  /// `estimate`.
  void look(const FrameSetLease& set, const std::optional<MotionPrediction>& predicted,
            PoseEstimate& estimate, std::vector<Alert>& alerts);
  /// These markers (by rising id, at most kMostIgnored), and no others, are told and nothing else
  /// from the next set on. No allocation.
  void ignore(std::span<const MarkerId> markers) {
    ignored_.assign(markers.begin(), markers.end());
  }
  static constexpr std::size_t kMostIgnored = 256;
  /// Cameras of `suspects` take no part where the others show two markers.
  void leave_out(CameraMask suspects, PoseEstimate& estimate);
  /// The set's instant, and each corner's from there: the cameras' skew and their rows' read-out.
  void time_corners(const FrameSetLease& set, PoseEstimate& estimate);

  /// Of mapped markers: those that the pose is to be found by, and those that are held against it
  /// only. At most kMaxObservations in all, the largest in the image.
  [[nodiscard]] std::span<SetObservation> used() { return used_; }
  [[nodiscard]] std::span<SetObservation> others() { return others_; }
  /// Both, as they are now.
  [[nodiscard]] std::span<const SetObservation> all();

  /// Cameras whose images are of use, and could be searched.
  [[nodiscard]] CameraMask usable() const { return usable_; }
  [[nodiscard]] CameraMask unhealthy_cameras() const { return health_.unhealthy(); }
  /// Cameras of the set whose images are of no use; those that could not be searched.
  [[nodiscard]] CameraMask unhealthy_frames() const { return unhealthy_frames_; }
  [[nodiscard]] CameraMask unsearched() const { return detector_.failed(); }
  void remember_images_of(const SetObserver& before) { health_.remember_images_of(before.health_); }

 private:
  /// A detection of the set, before it is known how many there are.
  struct Candidate {
    std::size_t camera;
    std::size_t index;  ///< among its camera's detections
    double area_px2;
  };
  void find_markers(const FrameSetLease& set, const std::optional<MotionPrediction>& predicted);
  void find_candidates(const FrameSetLease& set);
  void observe(const Candidate& candidate, PoseEstimate& estimate);

  const Rig& rig_;
  const MapIndex& map_;
  bool guided_;
  FrameDetector detector_;
  ExpectedWindows expected_;
  ImageHealth health_;
  DetectionWatch detection_watch_;
  CameraMask unhealthy_frames_ = 0;
  CameraMask usable_ = 0;
  std::vector<Candidate> candidates_;
  std::vector<MarkerId> ignored_;
  std::vector<SetObservation> used_;
  std::vector<SetObservation> others_;
  std::vector<SetObservation> all_;
};

}  // namespace waymark
