#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include "core/base/priority_mutex.h"
#include "core/camera/rig.h"
#include "core/detect/image_detector.h"
#include "core/marker/marker_catalog.h"
#include "locd/frames/frame_synchronizer.h"

namespace waymark {

/// Finds the markers in all images of a set at once, by worker threads made at start, one detector
/// per camera, and by no others. Frames that come
/// with their detections (a capture's detections.csv) are not looked at again.
class FrameDetector {
 public:
  /// `threads` 0: one per camera, at most as many as there are processors. The thread that calls
  /// detect is one of them; each of the others calls `begin_worker` first, where it is given. With
  /// a catalog without entries nothing is found in images. The rig must outlive the detector.
  FrameDetector(const Rig& rig, const MarkerCatalog& catalog, int threads,
                const std::function<void()>& begin_worker = {});
  ~FrameDetector();
  FrameDetector(const FrameDetector&) = delete;
  FrameDetector& operator=(const FrameDetector&) = delete;

  /// Detections of the cameras in `cameras`, looked for in each camera's windows (by camera; none:
  /// in the whole image); what is asked below is valid until the next call.
  void detect(const FrameSetLease& set, CameraMask cameras,
              std::span<const std::vector<ImageWindow>> windows = {});
  [[nodiscard]] std::span<const Detection> detections_of(std::size_t camera) const {
    return results_[camera];
  }
  /// Cameras whose images were searched for markers.
  [[nodiscard]] CameraMask searched() const { return searched_; }
  /// Those of them whose images could not be searched: the detector failed.
  [[nodiscard]] CameraMask failed() const { return failed_; }

 private:
  void work();
  /// Detects in cameras that no thread has taken yet; notes when the last is done.
  void take_cameras();
  void detect_in(std::size_t camera);

  const Rig& rig_;
  std::vector<std::unique_ptr<ImageDetector>> detectors_;
  std::vector<const FoundMarkers*> found_;  ///< the detectors' own
  std::array<std::span<const Detection>, kMaxCameras> results_;
  CameraMask searched_ = 0;
  CameraMask failed_ = 0;

  PriorityMutex mutex_;  ///< of everything below: the workers may be on SCHED_FIFO
  PriorityCondition begun_;
  PriorityCondition done_;
  const FrameSetLease* set_ = nullptr;
  std::span<const std::vector<ImageWindow>> windows_;
  CameraMask waiting_ = 0;  ///< cameras that no thread has taken
  int unfinished_ = 0;      ///< cameras taken or waiting
  bool stopping_ = false;
  std::vector<std::thread> workers_;
};

}  // namespace waymark
