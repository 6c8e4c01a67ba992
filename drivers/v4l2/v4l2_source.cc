#include "drivers/v4l2/v4l2_source.h"

#include <fmt/ranges.h>

#include <atomic>

#include "core/base/check.h"
#include "drivers/interrupt.h"
#include "drivers/stall_watch.h"
#include "drivers/v4l2/buffer_stamp.h"
#include "drivers/v4l2/buffer_stream.h"
#include "drivers/v4l2/camera_controls.h"
#include "drivers/v4l2/device_lookup.h"
#include "drivers/v4l2/turning_video_system.h"

namespace waymark {
namespace {

class V4l2Source final : public FrameSource {
 public:
  V4l2Source(std::shared_ptr<VideoSystem> system, const CameraOptions& options)
      : system_(turning(std::move(system), turns_)), options_(options) {}
  ~V4l2Source() override { V4l2Source::close(); }
  V4l2Source(const V4l2Source&) = delete;
  V4l2Source& operator=(const V4l2Source&) = delete;

  [[nodiscard]] const std::string& name() const override { return options_.name; }

  [[nodiscard]] Status start() override {
    close();
    stopped_ = false;
    wake_.clear();
    Status started = open_device();
    if (started) started = set_up();
    if (started) started = stream();
    if (!started) close();
    return started;
  }

  [[nodiscard]] Expected<std::optional<Frame>> next(Stamp deadline) override {
    auto frame = stream_ != nullptr ? next_of_stream(deadline)
                                    : fail(ErrorKind::unavailable, "{} is not open", name());
    if (!frame) close();
    return frame;
  }

  void stop() override {
    stopped_ = true;
    wake_.raise();
  }

  void close() override {
    frames_.end();
    stream_.reset();
    node_.reset();
    watch_ = {};
  }

  [[nodiscard]] Stamp last_turn() const override { return turns_.last(); }
  [[nodiscard]] std::uint64_t damaged() const override { return frames_.damaged(); }
  [[nodiscard]] std::uint64_t lost() const override { return frames_.lost(); }

  [[nodiscard]] std::string_view changed_settings() const override { return watch_.changed(); }

  [[nodiscard]] Expected<DeviceReport> inspect() override {
    const auto device = find_device(options_.device, find_cameras(*system_, options_.device));
    if (!device) return tl::make_unexpected(device.error());
    auto node = system_->open(device->node);
    if (!node) return tl::make_unexpected(node.error());
    DeviceReport report;
    report.text = fmt::format("{}, offers {}", name_of(*device), offered_formats(**node));
    for (const DeviceHolder& holder : (*node)->holders()) report.holders.push_back(holder.pid);
    return report;
  }

  [[nodiscard]] std::string describe() const override {
    if (stream_ == nullptr) return {};
    const FrameLayout& layout = format_.layout;
    std::string text =
        fmt::format("{} {}×{}", layout.pixels->name, layout.width_px, layout.height_px);
    if (format_.fps > 0) text += fmt::format(" at {:.4g}/s", format_.fps);
    text += exposure_us() > 0 ? fmt::format(", exposure {} µs", exposure_us())
                              : std::string(", exposure not known");
    if (controls_.gain) text += fmt::format(", gain {}", *controls_.gain);
    if (frames_.counted()) text += fmt::format(", stamps: {}", name_of(meaning_));
    return text + notes();
  }

 private:
  [[nodiscard]] Status open_device() {
    const auto device = find_device(options_.device, find_cameras(*system_, options_.device));
    if (!device) return tl::make_unexpected(device.error());
    if (auto same = check_serial(*device, options_); !same) return same;
    auto opened = system_->open(device->node);
    if (!opened) return tl::make_unexpected(opened.error());
    node_ = std::move(*opened);
    // While it is ours nobody else sets anything, unless with the same priority, or where a driver
    // knows none: for these there is the watch.
    __u32 priority = V4L2_PRIORITY_RECORD;
    (void)node_->request(VIDIOC_S_PRIORITY, &priority);
    return {};
  }

  [[nodiscard]] Status set_up() {
    const auto format = set_capture_format(*node_, options_.request);
    if (!format) return tl::make_unexpected(format.error());
    format_ = *format;
    auto applied = apply_controls(*node_, options_.controls);
    if (!applied) return tl::make_unexpected(applied.error());
    controls_ = std::move(*applied);
    watch_.begin(controls_.held, system_->now());
    return {};
  }

  [[nodiscard]] Status stream() {
    auto started = BufferStream::start(*node_, format_, FrameMaker::kBuffers);
    if (!started) return tl::make_unexpected(started.error());
    stream_ = std::move(*started);
    frames_.begin(format_.layout, stream_->memory(), stream_->count());
    stall_.begin(system_->now(), format_.fps);
    return {};
  }

  [[nodiscard]] Expected<std::optional<Frame>> next_of_stream(Stamp deadline) {
    for (bool promised = false;;) {
      if (auto given = give_returned(); !given) return tl::make_unexpected(given.error());
      watch_.look(*node_, system_->now());
      const auto filled = stream_->take();
      if (!filled) return tl::make_unexpected(filled.error());
      if (*filled) {
        auto frame = frame_of(**filled);
        if (!frame || *frame) return frame;
      } else if (promised) {
        return fail(ErrorKind::io, "{}: the driver reports an error", node_->path());
      }
      if (stall_.stalled(system_->now())) {
        return fail(ErrorKind::io, "{}: no whole frame for {:.1f} s; starting it again",
                    node_->path(), in_s(stall_.patience()));
      }
      promised = false;
      if (*filled) continue;
      if (stopped_) return std::nullopt;
      promised = node_->wait(deadline, wake_.descriptor());
      // Woken, a buffer can be given back; else the time is over.
      if (!promised && !wake_.clear()) return std::nullopt;
    }
  }

  /// What is no longer lent goes back to the driver.
  [[nodiscard]] Status give_returned() {
    while (const auto index = frames_.take_returned()) {
      if (auto given = stream_->give(*index); !given) return given;
    }
    return {};
  }

  /// nullopt when the frame can't be used: counted, and its buffer given back.
  [[nodiscard]] Expected<std::optional<Frame>> frame_of(const BufferStream::Filled& filled) {
    const FrameInfo info = info_of(filled);
    FrameMaker::Made made;
    if ((filled.flags & V4L2_BUF_FLAG_ERROR) != 0) {
      frames_.discard();
    } else {
      made = frames_.make(filled.index, filled.bytes, info);
    }
    if (made.whole) stall_.frame(info.arrival);
    if (made.buffer_is_free) {
      if (auto given = stream_->give(filled.index); !given) {
        return tl::make_unexpected(given.error());
      }
    }
    return std::move(made.frame);
  }

  [[nodiscard]] FrameInfo info_of(const BufferStream::Filled& filled) {
    meaning_ = stamp_meaning(filled.flags);
    const MidExposure mid =
        mid_exposure(meaning_, filled.stamp, {controls_.exposure, options_.readout});
    FrameInfo info;
    info.stamp = mid.stamp;
    info.quality = watch_.changed().empty() ? mid.quality : StampQuality::approximate;
    info.arrival = system_->now();
    info.sequence = frames_.count(filled.sequence);
    info.exposure = controls_.exposure;
    return info;
  }

  [[nodiscard]] double exposure_us() const {
    return std::chrono::duration<double, std::micro>(controls_.exposure).count();
  }
  [[nodiscard]] std::string notes() const {
    return controls_.notes.empty() ? "" : fmt::format("; {}", fmt::join(controls_.notes, "; "));
  }

  TurnStamp turns_;
  std::shared_ptr<VideoSystem> system_;
  CameraOptions options_;
  std::atomic<bool> stopped_{false};
  Interrupt wake_;  ///< raised by stop, and when a buffer is back for which the driver waits
  FrameMaker frames_{[this] { wake_.raise(); }};
  std::unique_ptr<VideoNode> node_;
  CaptureFormat format_;
  AppliedControls controls_;
  ControlWatch watch_;
  std::unique_ptr<BufferStream> stream_;  ///< of node_: ends before it does
  StallWatch stall_;
  StampMeaning meaning_ = StampMeaning::unknown;
};

}  // namespace

std::unique_ptr<FrameSource> v4l2_source(std::shared_ptr<VideoSystem> system,
                                         const CameraOptions& options) {
  WAYMARK_CHECK(options.check().has_value());
  return std::make_unique<V4l2Source>(std::move(system), options);
}

}  // namespace waymark
