#include <fmt/ranges.h>
#include <libcamera/control_ids.h>
#include <libcamera/framebuffer_allocator.h>

#include <cerrno>
#include <ctime>

#include "drivers/frame_maker.h"
#include "drivers/libcamera/camera_lookup.h"
#include "drivers/libcamera/camera_settings.h"
#include "drivers/libcamera/libcamera_source.h"
#include "drivers/libcamera/mapped_frame_buffer.h"
#include "drivers/libcamera/request_queue.h"
#include "drivers/libcamera/settings_check.h"
#include "drivers/libcamera/stamp_clock.h"
#include "drivers/mid_exposure.h"
#include "drivers/stall_watch.h"
#include "drivers/v4l2/camera_controls.h"
#include "drivers/v4l2/device_lookup.h"
#include "drivers/v4l2/turning_video_system.h"

namespace waymark {
namespace {

Stamp boottime_now() {
  timespec now{};
  ::clock_gettime(CLOCK_BOOTTIME, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

class LibcameraSource final : public FrameSource {
 public:
  LibcameraSource(std::shared_ptr<VideoSystem> system, const LibcameraOptions& options)
      : system_(turning(std::move(system), turns_)), options_(options) {}
  ~LibcameraSource() override { LibcameraSource::close(); }
  LibcameraSource(const LibcameraSource&) = delete;
  LibcameraSource& operator=(const LibcameraSource&) = delete;

  [[nodiscard]] const std::string& name() const override { return options_.camera.name; }

  [[nodiscard]] Status start() override {
    close();
    queue_.begin();
    Status started = acquire();
    if (started) started = configure();
    if (started) started = allocate();
    if (started) started = stream();
    if (!started) close();
    return started;
  }

  [[nodiscard]] Expected<std::optional<Frame>> next(Stamp deadline) override {
    auto frame = streams_ ? next_of_stream(deadline)
                          : fail(ErrorKind::unavailable, "{} is not open", name());
    if (!frame) close();
    return frame;
  }

  void stop() override { queue_.stop(); }

  void close() override {
    if (camera_ != nullptr) {
      if (streams_) camera_->stop();
      camera_->requestCompleted.disconnect(this);
      camera_->disconnected.disconnect(this);
    }
    streams_ = false;
    frames_.end();
    requests_.clear();
    memory_.reset();
    allocator_.reset();
    if (camera_ != nullptr) camera_->release();
    camera_.reset();
  }

  [[nodiscard]] Stamp last_turn() const override { return turns_.last(); }
  [[nodiscard]] std::uint64_t damaged() const override { return frames_.damaged(); }
  [[nodiscard]] std::uint64_t lost() const override { return frames_.lost(); }

  [[nodiscard]] Expected<DeviceReport> inspect() override {
    const auto camera = find_camera();
    if (!camera) return tl::make_unexpected(camera.error());
    DeviceReport report;
    report.text = fmt::format("{} ({}), offers {}", (*camera)->id(), model_of(**camera),
                              offered_formats(**camera));
    if (node_.empty()) return report;
    const auto node = system_->open(node_);
    if (!node) return tl::make_unexpected(node.error());
    for (const DeviceHolder& holder : (*node)->holders()) report.holders.push_back(holder.pid);
    return report;
  }

  [[nodiscard]] std::string describe() const override {
    if (!streams_) return {};
    const auto us = std::chrono::duration<double, std::micro>(exposure_).count();
    std::string text = fmt::format("{} {}×{} by libcamera, exposure {}", layout_.pixels->name,
                                   layout_.width_px, layout_.height_px,
                                   us > 0 ? fmt::format("{} µs", us) : std::string("not known"));
    if (found_.gain) text += fmt::format(", the device's gain {}", *found_.gain);
    if (frames_.counted()) text += fmt::format(", stamps: {}", name_of(meaning_));
    for (const std::string& note : found_.notes) text += "; " + note;
    return text;
  }

 private:
  [[nodiscard]] Expected<std::shared_ptr<libcamera::Camera>> find_camera() {
    if (manager_ == nullptr) {
      auto manager = shared_manager();
      if (!manager) return tl::make_unexpected(manager.error());
      manager_ = std::move(*manager);
      turns_.touch(system_->now());
    }
    auto camera = options_.id.empty() ? find_by_device() : find_by_id();
    if (camera && *camera == nullptr) {
      std::vector<std::string> ids;
      for (const auto& other : manager_->cameras()) ids.push_back(other->id());
      // libcamera 0.0.3 misses cameras that come while it starts, for good: another one may see
      // them.
      let_go(manager_);
      return fail(
          ErrorKind::unavailable,
          "{}: libcamera has no such camera; it has: {}; `cam --list` shows what hinders it",
          options_.id.empty() ? options_.camera.device.text() : options_.id,
          ids.empty() ? std::string("none") : fmt::format("{}", fmt::join(ids, ", ")));
    }
    return camera;
  }

  /// Null when there is none.
  [[nodiscard]] Expected<std::shared_ptr<libcamera::Camera>> find_by_id() {
    if (!options_.camera.serial.empty()) {
      return fail(ErrorKind::config,
                  "{}: rig.yaml states a serial number, which can't be told of a camera by "
                  "libcamera's name; use device = \"serial={}\"",
                  name(), options_.camera.serial);
    }
    auto camera = manager_->get(options_.id);
    node_ = camera == nullptr ? "" : capture_node_of(camera, *manager_, *system_);
    return camera;
  }
  [[nodiscard]] Expected<std::shared_ptr<libcamera::Camera>> find_by_device() {
    const auto device =
        find_device(options_.camera.device, find_cameras(*system_, options_.camera.device));
    if (!device) return tl::make_unexpected(device.error());
    if (auto same = check_serial(*device, options_.camera); !same) {
      return tl::make_unexpected(same.error());
    }
    node_ = device->node;
    return camera_of(*manager_, node_);
  }

  [[nodiscard]] Status acquire() {
    auto camera = find_camera();
    if (!camera) return tl::make_unexpected(camera.error());
    const int failed = (*camera)->acquire();
    turns_.touch(system_->now());
    if (failed == -EBUSY) {
      return fail(ErrorKind::unavailable,
                  "{}: another program uses it; `sudo fuser -v /dev/media* /dev/video*` names it",
                  (*camera)->id());
    }
    if (failed < 0) {
      return fail(failed == -EACCES ? ErrorKind::permission : ErrorKind::unavailable,
                  "{}: can't be acquired: {}; is the user in group video?", (*camera)->id(),
                  reason(failed));
    }
    camera_ = std::move(*camera);
    return {};
  }

  [[nodiscard]] Status configure() {
    auto settings = stream_settings(*camera_, options_.camera.request);
    if (!settings) return tl::make_unexpected(settings.error());
    configuration_ = std::move(settings->configuration);
    layout_ = settings->layout;
    return done("can't be configured", camera_->configure(configuration_.get()));
  }

  [[nodiscard]] Status allocate() {
    libcamera::Stream* const stream = configuration_->at(0).stream();
    allocator_ = std::make_unique<libcamera::FrameBufferAllocator>(camera_);
    if (auto given = done("can't get buffers", allocator_->allocate(stream)); !given) return given;
    const auto& buffers = allocator_->buffers(stream);
    if (buffers.size() < FrameMaker::kFewestBuffers || buffers.size() > BufferLender::kMaxBuffers) {
      return fail(ErrorKind::unavailable, "{}: gives {} buffers; {} to {} will do", camera_->id(),
                  buffers.size(), FrameMaker::kFewestBuffers, BufferLender::kMaxBuffers);
    }
    memory_ = std::make_shared<Memory>();
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      memory_->push_back(map_first_plane(*buffers[i]));
      auto request = camera_->createRequest(i);
      if (memory_->back() == nullptr || request == nullptr ||
          request->addBuffer(stream, buffers[i].get()) < 0) {
        return fail(ErrorKind::unavailable, "{}: a buffer can't be used", camera_->id());
      }
      requests_.push_back(std::move(request));
    }
    return {};
  }

  [[nodiscard]] Status stream() {
    auto controls = start_controls(camera_->controls(), options_.camera);
    if (!controls) return tl::make_unexpected(controls.error());
    camera_->requestCompleted.connect(this, [this](libcamera::Request* r) { queue_.complete(r); });
    camera_->disconnected.connect(this, [this] { queue_.disconnect(); });
    if (auto started = done("can't stream", camera_->start(&*controls)); !started) return started;
    streams_ = true;
    settled_ = false;
    settings_.begin();
    found_ = {};
    frames_.begin(layout_, memory_, requests_.size());
    stall_.begin(system_->now(), options_.camera.request.fps);
    // Cameras of some drivers, USB ones among them, take controls from requests alone.
    requests_.front()->controls().merge(*controls);
    for (auto& request : requests_) {
      if (auto given = queue(*request); !given) return given;
    }
    return {};
  }

  [[nodiscard]] Expected<std::optional<Frame>> next_of_stream(Stamp deadline) {
    for (;;) {
      while (const auto index = frames_.take_returned()) {
        if (auto given = recycle(*requests_[*index]); !given) {
          return tl::make_unexpected(given.error());
        }
      }
      libcamera::Request* const request = queue_.take(deadline);
      if (queue_.disconnected()) {
        return fail(ErrorKind::unavailable, "{}: the device is gone; plug it in again",
                    camera_->id());
      }
      if (request != nullptr) {
        auto frame = frame_of(*request);
        if (!frame || *frame) return frame;
      }
      if (stall_.stalled(system_->now())) {
        return fail(ErrorKind::io, "{}: no whole frame for {:.1f} s; starting it again",
                    camera_->id(), in_s(stall_.patience()));
      }
      // Woken, a request can be given back; else the time is over.
      if (request == nullptr && !queue_.was_woken()) return std::nullopt;
    }
  }

  /// nullopt when the frame can't be used: counted, and its request queued again.
  [[nodiscard]] Expected<std::optional<Frame>> frame_of(libcamera::Request& request) {
    const libcamera::FrameBuffer& buffer = *request.buffers().begin()->second;
    const libcamera::FrameMetadata& about = buffer.metadata();
    if (request.status() == libcamera::Request::RequestCancelled ||
        about.status == libcamera::FrameMetadata::FrameCancelled) {
      return fail(ErrorKind::io, "{}: libcamera cancelled a request; starting it again",
                  camera_->id());
    }
    const bool damaged =
        about.status == libcamera::FrameMetadata::FrameError || about.planes().empty();
    if (!damaged && !settled_) {
      const auto settled = is_as_configured(request);
      if (!settled) return tl::make_unexpected(settled.error());
      settled_ = *settled;
      if (!settled_) return passed_over(request);
    }
    const auto index = static_cast<std::uint32_t>(request.cookie());
    const FrameInfo info = info_of(request, about);
    FrameMaker::Made made;
    if (damaged) {
      frames_.discard();
    } else {
      const std::size_t filled =
          std::min<std::size_t>(about.planes()[0].bytesused, buffer.planes()[0].length);
      made = frames_.make(index, {(*memory_)[index].get(), filled}, info);
    }
    if (made.whole) stall_.frame(info.arrival);
    if (made.buffer_is_free) {
      if (auto given = recycle(request); !given) return tl::make_unexpected(given.error());
    }
    return std::move(made.frame);
  }

  /// What only a stream that runs shows: whether the image is whole, and how the camera took what
  /// was set; false: not yet. libcamera 0.0.3 tells nothing of USB cameras' settings; the device
  /// does.
  [[nodiscard]] Expected<bool> is_as_configured(libcamera::Request& request) {
    const libcamera::ControlList& metadata = request.metadata();
    if (auto whole = check_crop(camera_->id(), metadata, camera_->properties()); !whole) {
      return tl::make_unexpected(whole.error());
    }
    auto taken = settings_.look(metadata, options_.camera);
    if (!taken || !*taken) return taken;
    if (node_.empty() || metadata.contains(libcamera::controls::ExposureTime.id())) return true;
    auto node = system_->open(node_);
    if (!node) return tl::make_unexpected(node.error());
    auto found = read_controls(**node, options_.camera.controls);
    if (!found) return tl::make_unexpected(found.error());
    found_ = std::move(*found);
    return true;
  }

  /// A frame from before the settings took effect: nobody gets it, and it is not lost either.
  [[nodiscard]] Expected<std::optional<Frame>> passed_over(libcamera::Request& request) {
    stall_.frame(system_->now());
    if (auto given = recycle(request); !given) return tl::make_unexpected(given.error());
    return std::nullopt;
  }

  [[nodiscard]] FrameInfo info_of(libcamera::Request& request,
                                  const libcamera::FrameMetadata& about) {
    const auto sensor = request.metadata().get(libcamera::controls::SensorTimestamp);
    exposure_ = exposure_of(request.metadata(), found_.exposure);
    meaning_ = stamp_meaning(request.metadata());
    const Stamp now = system_->now();
    const Stamp stamp = to_monotonic(
        Stamp(sensor ? *sensor : static_cast<std::int64_t>(about.timestamp)), now, boottime_now());
    const MidExposure mid = mid_exposure(meaning_, stamp, {exposure_, options_.camera.readout});
    FrameInfo info;
    info.stamp = mid.stamp;
    info.quality = mid.quality;
    info.arrival = now;
    info.sequence = frames_.count(about.sequence);
    info.exposure = exposure_;
    return info;
  }

  [[nodiscard]] Status recycle(libcamera::Request& request) {
    request.reuse(libcamera::Request::ReuseBuffers);
    return queue(request);
  }
  [[nodiscard]] Status queue(libcamera::Request& request) {
    return done("takes no request", camera_->queueRequest(&request));
  }
  /// The error of one of libcamera's calls, which return a negative errno.
  [[nodiscard]] Status done(std::string_view what, int result) {
    turns_.touch(system_->now());
    if (result >= 0) return {};
    return fail(result == -ENODEV ? ErrorKind::unavailable : ErrorKind::io, "{}: {}: {}",
                camera_->id(), what, reason(result));
  }

  using Memory = std::vector<std::shared_ptr<const std::uint8_t>>;

  TurnStamp turns_;
  std::shared_ptr<VideoSystem> system_;
  LibcameraOptions options_;
  RequestQueue queue_;
  FrameMaker frames_{[this] { queue_.wake(); }};
  StallWatch stall_;
  std::shared_ptr<libcamera::CameraManager> manager_;  ///< outlives its cameras
  std::shared_ptr<libcamera::Camera> camera_;
  std::unique_ptr<libcamera::CameraConfiguration> configuration_;
  FrameLayout layout_;
  std::unique_ptr<libcamera::FrameBufferAllocator> allocator_;
  std::shared_ptr<Memory> memory_;  ///< per buffer its first plane
  std::vector<std::unique_ptr<libcamera::Request>> requests_;
  std::string node_;       ///< of Video4Linux; empty: not known
  AppliedControls found_;  ///< read back from it
  Stamp exposure_{0};      ///< of the last frame; 0: not known
  StampMeaning meaning_ = StampMeaning::unknown;
  bool streams_ = false;
  SettingsCheck settings_;
  bool settled_ = false;  ///< the running stream's frames are as configured
};

}  // namespace
}  // namespace waymark

void waymark_make_libcamera_source(std::shared_ptr<waymark::VideoSystem> system,
                                   const waymark::LibcameraOptions& options,
                                   std::unique_ptr<waymark::FrameSource>& result) {
  result = std::make_unique<waymark::LibcameraSource>(std::move(system), options);
}
