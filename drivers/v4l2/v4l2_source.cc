#include "drivers/v4l2/v4l2_source.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "drivers/buffer_lender.h"
#include "drivers/interrupt.h"
#include "drivers/v4l2/buffer_stamp.h"
#include "drivers/v4l2/buffer_stream.h"

namespace waymark {
namespace {

constexpr std::size_t kDriverBuffers = 2;                  ///< never lent
constexpr Stamp kSlowestPeriod = std::chrono::seconds(1);  ///< of a device that does not say

class V4l2Source final : public FrameSource {
 public:
  V4l2Source(std::shared_ptr<VideoSystem> system, const V4l2Options& options)
      : system_(std::move(system)), options_(options) {}
  ~V4l2Source() override { V4l2Source::close(); }
  V4l2Source(const V4l2Source&) = delete;
  V4l2Source& operator=(const V4l2Source&) = delete;

  [[nodiscard]] const std::string& name() const override { return options_.name; }

  [[nodiscard]] Status start() override {
    close();
    interrupt_.clear();
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

  void stop() override { interrupt_.raise(); }

  void close() override {
    lender_.end();
    stream_.reset();
    node_.reset();
    images_.reset();
  }

  [[nodiscard]] std::uint64_t damaged() const override { return damaged_; }
  [[nodiscard]] std::uint64_t lost() const override { return lost_; }

  [[nodiscard]] Expected<DeviceReport> inspect() override {
    const auto device = find_device(options_.device, system_->devices());
    if (!device) return tl::make_unexpected(device.error());
    auto node = system_->open(device->node);
    if (!node) return tl::make_unexpected(node.error());
    DeviceReport report;
    report.text = fmt::format("{}, offers {}", name_of(*device), offered_formats(**node));
    if (const auto holder = (*node)->holder()) report.holder_pid = holder->pid;
    return report;
  }

  [[nodiscard]] std::string describe() const override {
    if (stream_ == nullptr) return {};
    std::string text =
        fmt::format("{} {}×{}", format_.pixels->name, format_.width_px, format_.height_px);
    if (format_.fps > 0) text += fmt::format(" at {:.4g}/s", format_.fps);
    text += exposure_us() > 0 ? fmt::format(", exposure {} µs", exposure_us())
                              : std::string(", exposure not known");
    if (controls_.gain) text += fmt::format(", gain {}", *controls_.gain);
    if (sequence_) text += fmt::format(", stamps: {}", name_of(meaning_));
    return text + notes();
  }

 private:
  [[nodiscard]] Status open_device() {
    const auto device = find_device(options_.device, system_->devices());
    if (!device) return tl::make_unexpected(device.error());
    if (!options_.serial.empty() && device->serial != options_.serial) {
      return fail(ErrorKind::config,
                  "{}: has serial number \"{}\", rig.yaml's {} has \"{}\": another camera needs "
                  "another calibration",
                  device->node, device->serial, name(), options_.serial);
    }
    auto opened = system_->open(device->node);
    if (!opened) return tl::make_unexpected(opened.error());
    node_ = std::move(*opened);
    return {};
  }

  [[nodiscard]] Status set_up() {
    const auto format = set_capture_format(*node_, options_.request);
    if (!format) return tl::make_unexpected(format.error());
    format_ = *format;
    auto applied = apply_controls(*node_, options_.controls);
    if (!applied) return tl::make_unexpected(applied.error());
    controls_ = std::move(*applied);
    return {};
  }

  [[nodiscard]] Status stream() {
    auto started = BufferStream::start(*node_, format_, kV4l2Buffers);
    if (!started) return tl::make_unexpected(started.error());
    stream_ = std::move(*started);
    const std::size_t lendable = stream_->count() - kDriverBuffers;
    if (in_place()) {
      lender_.begin(stream_->memory(), lendable);
    } else {
      images_ = std::make_shared<std::vector<GrayImage>>(
          lendable, GrayImage(format_.width_px, format_.height_px));
      free_images_.resize(lendable);
      for (std::uint32_t i = 0; i < lendable; ++i) free_images_[i] = i;
      lender_.begin(images_, lendable);
    }
    sequence_.reset();
    last_good_ = system_->now();
    return {};
  }

  /// Whether frames are lent where the driver put them.
  [[nodiscard]] bool in_place() const {
    return format_.pixels->kind == PixelFormat::Kind::luma_first;
  }

  [[nodiscard]] Expected<std::optional<Frame>> next_of_stream(Stamp deadline) {
    for (bool promised = false;;) {
      if (auto given = give_returned(); !given) return tl::make_unexpected(given.error());
      const auto filled = stream_->take();
      if (!filled) return tl::make_unexpected(filled.error());
      if (*filled) {
        auto frame = frame_of(**filled);
        if (!frame || *frame) return frame;
      } else if (promised) {
        return fail(ErrorKind::io, "{}: the driver reports an error", node_->path());
      }
      if (system_->now() - last_good_ > patience()) {
        return fail(ErrorKind::io, "{}: no whole frame for {:.1f} s; starting it again",
                    node_->path(), std::chrono::duration<double>(patience()).count());
      }
      promised = !*filled && node_->wait(deadline, interrupt_.descriptor());
      if (!*filled && !promised) return std::nullopt;
    }
  }

  [[nodiscard]] Stamp patience() const {
    const Stamp period =
        format_.fps > 0 ? Stamp(static_cast<Stamp::rep>(1e9 / format_.fps)) : kSlowestPeriod;
    return std::chrono::seconds(2) + 5 * period;
  }

  /// What is no longer lent goes back to where it is filled.
  [[nodiscard]] Status give_returned() {
    for (const std::uint32_t index : lender_.take_returned()) {
      if (!in_place()) {
        free_images_.push_back(index);
      } else if (auto given = stream_->give(index); !given) {
        return given;
      }
    }
    return {};
  }

  /// nullopt when the frame can't be used: counted, and its buffer given back.
  [[nodiscard]] Expected<std::optional<Frame>> frame_of(const BufferStream::Filled& filled) {
    const FrameInfo info = info_of(filled);
    const bool whole =
        (filled.flags & V4L2_BUF_FLAG_ERROR) == 0 && filled.bytes.size() >= format_.least_bytes();
    std::optional<Frame> frame;
    if (!whole) {
      ++damaged_;
    } else if (in_place()) {
      frame = lend_in_place(filled, info);
    } else {
      frame = convert(filled, info);
    }
    if (frame) last_good_ = info.arrival;
    if (!frame || !in_place()) {
      if (auto given = stream_->give(filled.index); !given) {
        return tl::make_unexpected(given.error());
      }
    }
    return frame;
  }

  [[nodiscard]] std::optional<Frame> lend_in_place(const BufferStream::Filled& filled,
                                                   const FrameInfo& info) {
    const auto slot = lender_.lend(filled.index);
    if (!slot) {
      ++lost_;
      return std::nullopt;
    }
    const GrayView view{filled.bytes.data(), format_.width_px, format_.height_px,
                        format_.stride_bytes};
    return Frame(info, view, nullptr, &lender_, *slot);
  }

  [[nodiscard]] std::optional<Frame> convert(const BufferStream::Filled& filled,
                                             const FrameInfo& info) {
    if (free_images_.empty()) {
      ++lost_;
      return std::nullopt;
    }
    const std::uint32_t index = free_images_.back();
    GrayImage& image = (*images_)[index];
    if (!convert_to_gray(*format_.pixels, filled.bytes, format_.stride_bytes, image)) {
      ++damaged_;
      return std::nullopt;
    }
    const auto slot = lender_.lend(index);
    WAYMARK_CHECK(slot.has_value());  // as many images as may be lent
    free_images_.pop_back();
    return Frame(info, image.view(), nullptr, &lender_, *slot);
  }

  [[nodiscard]] FrameInfo info_of(const BufferStream::Filled& filled) {
    if (sequence_) {
      // The device counts in 32 bits; a driver that does not count repeats itself.
      const auto step = std::max<std::uint32_t>(1, filled.sequence - device_sequence_);
      if (step < kWildStep) lost_ += step - 1;
      *sequence_ += step < kWildStep ? step : 1;
    } else {
      sequence_ = filled.sequence;
    }
    device_sequence_ = filled.sequence;
    meaning_ = stamp_meaning(filled.flags);
    const MidExposure mid =
        mid_exposure(meaning_, filled.stamp, {controls_.exposure, options_.readout});
    FrameInfo info;
    info.stamp = mid.stamp;
    info.quality = mid.quality;
    info.arrival = system_->now();
    info.sequence = *sequence_;
    info.exposure = controls_.exposure;
    return info;
  }

  [[nodiscard]] double exposure_us() const {
    return std::chrono::duration<double, std::micro>(controls_.exposure).count();
  }
  [[nodiscard]] std::string notes() const {
    return controls_.notes.empty() ? "" : fmt::format("; {}", fmt::join(controls_.notes, "; "));
  }

  /// A larger step of the device's count is a new count (1e3–1e9).
  static constexpr std::uint32_t kWildStep = 1'000'000;

  std::shared_ptr<VideoSystem> system_;
  V4l2Options options_;
  Interrupt interrupt_;
  BufferLender lender_;
  std::unique_ptr<VideoNode> node_;
  CaptureFormat format_;
  AppliedControls controls_;
  std::unique_ptr<BufferStream> stream_;            ///< of node_: ends before it does
  std::shared_ptr<std::vector<GrayImage>> images_;  ///< of converted frames
  std::vector<std::uint32_t> free_images_;
  std::optional<std::uint64_t> sequence_;  ///< of the last frame; none since start: nullopt
  std::uint32_t device_sequence_ = 0;
  StampMeaning meaning_ = StampMeaning::unknown;
  Stamp last_good_{0};
  std::uint64_t damaged_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> v4l2_source(std::shared_ptr<VideoSystem> system,
                                         const V4l2Options& options) {
  return std::make_unique<V4l2Source>(std::move(system), options);
}

}  // namespace waymark
