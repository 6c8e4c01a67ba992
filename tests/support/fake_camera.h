#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <numeric>
#include <string>
#include <vector>

#include "drivers/buffer_lender.h"
#include "drivers/frame_source.h"
#include "drivers/monotonic_clock.h"
#include "drivers/turn_stamp.h"

namespace waymark::test {

/// A camera that gives the frames a test hands it, fails when told to, and can be stuck in a call
/// as a bad driver is.
class FakeCamera final : public FrameSource {
 public:
  FakeCamera(std::string name, int width_px, int height_px)
      : name_(std::move(name)), images_(kImages, GrayImage(width_px, height_px, 90)) {
    lender_.begin(nullptr, kImages);
    std::iota(free_.begin(), free_.end(), 0U);
  }

  void give(Stamp stamp) {
    const std::lock_guard lock(mutex_);
    due_.push_back(stamp);
    changed_.notify_all();
  }
  /// From now on start and next fail with this message; empty: they work again.
  void fail_with(const std::string& message, ErrorKind kind = ErrorKind::unavailable) {
    const std::lock_guard lock(mutex_);
    failure_ = message;
    failure_kind_ = kind;
    changed_.notify_all();
  }
  /// Likewise, of next alone.
  void fail_next_with(const std::string& message, ErrorKind kind) {
    fail_with(message, kind);
    only_next_fails_ = true;
  }
  /// The next call does not return before release().
  void get_stuck() { stuck_ = true; }
  void release() {
    stuck_ = false;
    stuck_.notify_all();
  }
  /// A call to the device returns, while another is under way.
  void turn(Stamp now) { turns_.touch(now); }
  /// From now on frames arrive so long before next gives them.
  void take_long(Stamp time) { delay_ = time; }
  /// Whether a call waits for release().
  [[nodiscard]] bool is_stuck() const { return held_; }
  [[nodiscard]] std::size_t starts() const { return started().size(); }
  /// When start was called.
  [[nodiscard]] std::vector<Stamp> started() const {
    const std::lock_guard lock(mutex_);
    return started_;
  }
  [[nodiscard]] bool closed() const { return closed_; }

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] Status start() override {
    stay_stuck();
    const std::lock_guard lock(mutex_);
    stopped_ = false;
    started_.push_back(monotonic_now());
    if (!failure_.empty() && !only_next_fails_) return fail(failure_kind_, "{}", failure_);
    return {};
  }
  [[nodiscard]] Expected<std::optional<Frame>> next(Stamp deadline) override {
    stay_stuck();
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, as_time_point(deadline),
                        [&] { return stopped_ || !due_.empty() || !failure_.empty(); });
    if (!failure_.empty()) return fail(failure_kind_, "{}", failure_);
    if (stopped_ || due_.empty()) return std::nullopt;
    FrameInfo info;
    info.stamp = due_.front();
    info.arrival = monotonic_now() - delay_;
    info.sequence = sequence_++;
    due_.pop_front();
    while (const auto returned = lender_.take_returned()) free_.push_back(*returned);
    if (free_.empty()) {
      ++lost_;
      return std::nullopt;
    }
    const std::uint32_t index = free_.back();
    free_.pop_back();
    GrayImage& image = images_[index];
    // No two images are alike, as of a real sensor.
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      image.pixels[i] = static_cast<std::uint8_t>(60 + (7 * i + 13 * info.sequence) % 101);
    }
    return Frame(info, image.view(), nullptr, &lender_, *lender_.lend(index));
  }
  [[nodiscard]] Expected<DeviceReport> inspect() override { return DeviceReport{name_, {}}; }
  void stop() override {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }
  void close() override { closed_ = true; }
  [[nodiscard]] Stamp last_turn() const override { return turns_.last(); }
  [[nodiscard]] std::string describe() const override { return "64×48, fake"; }
  /// Frames that were due while all images were lent.
  [[nodiscard]] std::uint64_t lost() const override { return lost_; }

 private:
  void stay_stuck() {
    held_ = stuck_.load();
    stuck_.wait(true);
    held_ = false;
  }

  static constexpr std::size_t kImages = 8;

  std::string name_;
  std::vector<GrayImage> images_;
  BufferLender lender_;
  std::vector<std::uint32_t> free_ = std::vector<std::uint32_t>(kImages);  ///< indices of images
  std::uint64_t lost_ = 0;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Stamp> due_;
  std::vector<Stamp> started_;
  std::string failure_;
  ErrorKind failure_kind_ = ErrorKind::unavailable;
  std::atomic<bool> only_next_fails_{false};
  bool stopped_ = false;
  std::uint64_t sequence_ = 0;
  Stamp delay_{0};  ///< set before frames are given
  TurnStamp turns_;
  std::atomic<bool> closed_{false};
  std::atomic<bool> stuck_{false};
  std::atomic<bool> held_{false};
};

}  // namespace waymark::test
