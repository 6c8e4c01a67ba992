#include "locd/pose/frame_detector.h"

#include <algorithm>
#include <bit>

#include "core/base/parallel.h"

namespace waymark {
namespace {

bool has_size_of(const GrayView& image, const CameraModel& camera) {
  return image.data != nullptr && image.width_px == camera.parameters().width_px &&
         image.height_px == camera.parameters().height_px;
}

}  // namespace

FrameDetector::FrameDetector(const Rig& rig, const MarkerCatalog& catalog, int threads,
                             const std::function<void()>& begin_worker)
    : rig_(rig), found_(rig.cameras.size()) {
  if (catalog.entries().empty()) return;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    detectors_.push_back(std::make_unique<ImageDetector>(catalog));
  }
  const int wanted =
      std::min<int>(effective_threads(threads), static_cast<int>(rig.cameras.size()));
  for (int i = 1; i < wanted; ++i) {
    workers_.emplace_back([this, begin_worker] {
      if (begin_worker) begin_worker();
      work();
    });
  }
}

FrameDetector::~FrameDetector() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  begun_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void FrameDetector::detect(const FrameSetLease& set, CameraMask cameras,
                           std::span<const std::vector<ImageWindow>> windows) {
  CameraMask to_search = 0;
  for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
    results_[c] = {};
    if ((cameras & set.cameras & camera_bit(c)) == 0) continue;
    const Frame& frame = set.frames[c];
    if (frame.detections() != nullptr) {
      results_[c] = frame.detections()->detections;
    } else if (!detectors_.empty() && has_size_of(frame.image(), rig_.cameras[c].model)) {
      to_search |= camera_bit(c);
    }
  }
  searched_ = to_search;
  failed_ = 0;
  if (to_search == 0) return;
  {
    const std::lock_guard lock(mutex_);
    set_ = &set;
    windows_ = windows;
    waiting_ = to_search;
    unfinished_ = std::popcount(to_search);
  }
  begun_.notify_all();
  take_cameras();
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return unfinished_ == 0; });
  set_ = nullptr;
  for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
    if ((to_search & camera_bit(c)) == 0) continue;
    results_[c] = found_[c]->detections;
    if (!found_[c]->failure.empty()) failed_ |= camera_bit(c);
  }
}

void FrameDetector::work() {
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      begun_.wait(lock, [this] { return stopping_ || waiting_ != 0; });
      if (stopping_) return;
    }
    take_cameras();
  }
}

void FrameDetector::take_cameras() {
  for (;;) {
    std::size_t camera = 0;
    {
      const std::lock_guard lock(mutex_);
      if (waiting_ == 0) return;
      camera = static_cast<std::size_t>(std::countr_zero(waiting_));
      waiting_ &= waiting_ - 1;
    }
    detect_in(camera);
    const std::lock_guard lock(mutex_);
    if (--unfinished_ == 0) done_.notify_all();
  }
}

void FrameDetector::detect_in(std::size_t camera) {
  std::span<const ImageWindow> windows;
  if (camera < windows_.size()) windows = windows_[camera];
  const RigCamera& by = rig_.cameras[camera];
  found_[camera] = &detectors_[camera]->detect(set_->frames[camera].image(), by.model, windows,
                                               by.edge_bias_px.value_or(0));
}

}  // namespace waymark
