#pragma once

#include <libcamera/request.h>

#include <mutex>
#include <utility>
#include <vector>

#include "core/base/priority_mutex.h"
#include "core/geometry/stamp.h"
#include "drivers/buffer_lender.h"
#include "drivers/monotonic_clock.h"

namespace waymark {

/// Requests that libcamera's thread has completed and the camera's own thread has not yet taken.
class RequestQueue {
 public:
  /// A stream begins.
  void begin() {
    const std::lock_guard lock(mutex_);
    completed_.clear();
    completed_.reserve(BufferLender::kMaxBuffers);
    stopped_ = disconnected_ = woken_ = false;
  }
  /// From libcamera's thread.
  void complete(libcamera::Request* request) {
    const std::lock_guard lock(mutex_);
    completed_.push_back(request);
    changed_.notify_all();
  }
  void disconnect() {
    const std::lock_guard lock(mutex_);
    disconnected_ = true;
    changed_.notify_all();
  }
  /// From any thread: ends a waiting take.
  void stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }

  /// From any thread: ends a waiting take once, or the next.
  void wake() {
    const std::lock_guard lock(mutex_);
    woken_ = true;
    changed_.notify_all();
  }
  /// Whether wake was called since the last question.
  [[nodiscard]] bool was_woken() {
    const std::lock_guard lock(mutex_);
    return std::exchange(woken_, false);
  }

  /// The oldest; null at the deadline, after stop, when woken and when the camera is gone.
  [[nodiscard]] libcamera::Request* take(Stamp deadline) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, as_time_point(deadline),
                        [&] { return stopped_ || disconnected_ || woken_ || !completed_.empty(); });
    if (disconnected_ || completed_.empty()) return nullptr;
    libcamera::Request* const oldest = completed_.front();
    completed_.erase(completed_.begin());
    return oldest;
  }
  [[nodiscard]] bool disconnected() const {
    const std::lock_guard lock(mutex_);
    return disconnected_;
  }

 private:
  mutable PriorityMutex mutex_;
  PriorityCondition changed_;
  std::vector<libcamera::Request*> completed_;  ///< oldest first
  bool stopped_ = false;
  bool disconnected_ = false;
  bool woken_ = false;
};

}  // namespace waymark
