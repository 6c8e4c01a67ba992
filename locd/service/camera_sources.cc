#include "locd/service/camera_sources.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "drivers/libcamera/libcamera_source.h"
#include "drivers/replay_source.h"
#include "drivers/v4l2/device_lookup.h"
#include "drivers/v4l2/v4l2_source.h"

namespace waymark {
namespace {

using Source = std::unique_ptr<FrameSource>;

/// Makes the sources one by one; cameras that are of one kind share what they can.
class SourceMaker {
 public:
  Expected<Source> make(const Config::Camera& camera, const RigCamera& in_rig) {
    switch (camera.driver) {
      case CameraDriver::replay:
        return replay(camera);
      case CameraDriver::v4l2:
        return v4l2(camera, in_rig);
      case CameraDriver::libcamera:
        return libcamera(camera, in_rig);
    }
    return fail(ErrorKind::internal, "[[camera]] {}: unknown driver", camera.name);
  }

 private:
  Expected<Source> replay(const Config::Camera& camera) {
    if (!replayed_.contains(camera.device)) {
      ReplayOptions options;
      options.realtime = true;
      options.loop = true;
      auto capture = ReplayCapture::open(camera.device, options);
      if (!capture) return tl::make_unexpected(capture.error());
      replayed_[camera.device] = ReplayCapture::sources(*capture);
    }
    auto& of_capture = replayed_[camera.device];
    const auto found = std::find_if(of_capture.begin(), of_capture.end(), [&](const auto& source) {
      return source != nullptr && source->name() == camera.name;
    });
    if (found == of_capture.end()) {
      return fail(ErrorKind::config, "[[camera]] {}: {} has no such camera", camera.name,
                  camera.device);
    }
    return std::move(*found);
  }

  Expected<Source> v4l2(const Config::Camera& camera, const RigCamera& in_rig) {
    auto options = options_of(camera, in_rig);
    if (!options) return tl::make_unexpected(options.error());
    if (auto named = name_device(camera, *options); !named) {
      return tl::make_unexpected(named.error());
    }
    return v4l2_source(system(), *options);
  }

  Expected<Source> libcamera(const Config::Camera& camera, const RigCamera& in_rig) {
    auto options = options_of(camera, in_rig);
    if (!options) return tl::make_unexpected(options.error());
    LibcameraOptions chosen{std::move(*options), ""};
    if (is_libcamera_id(camera.device)) {
      chosen.id = camera.device;
    } else if (auto named = name_device(camera, chosen.camera); !named) {
      return tl::make_unexpected(named.error());
    }
    return libcamera_source(system(), chosen);
  }

  static Status name_device(const Config::Camera& camera, CameraOptions& options) {
    auto device = parse_device_identity(camera.device);
    if (!device) {
      return fail(ErrorKind::config, "[[camera]] {}: device {}", camera.name,
                  device.error().message);
    }
    options.device = std::move(*device);
    return {};
  }

  static Expected<CameraOptions> options_of(const Config::Camera& camera, const RigCamera& in_rig) {
    CameraOptions options;
    options.name = camera.name;
    options.serial = in_rig.serial;
    options.request.width_px = in_rig.model.parameters().width_px;
    options.request.height_px = in_rig.model.parameters().height_px;
    options.request.fps = camera.fps;
    if (!camera.format.empty()) {
      options.request.pixels = find_pixel_format(camera.format);
      if (options.request.pixels == nullptr) return unknown_format(camera);
    }
    options.controls = {camera.exposure_us, camera.gain, camera.white_balance_k, camera.focus,
                        camera.power_line_hz};
    options.readout = from_us(in_rig.readout_us.value_or(0));
    return options;
  }

  std::shared_ptr<VideoSystem> system() {
    if (system_ == nullptr) system_ = kernel_video_system();
    return system_;
  }

  static tl::unexpected<Error> unknown_format(const Config::Camera& camera) {
    std::vector<std::string_view> names;
    for (const PixelFormat& format : pixel_formats()) names.push_back(format.name);
    return fail(ErrorKind::config, "[[camera]] {}: format \"{}\" is none of {}", camera.name,
                camera.format, fmt::join(names, ", "));
  }

  std::map<std::string, std::vector<Source>> replayed_;  ///< per capture; what is taken is null
  std::shared_ptr<VideoSystem> system_;
};

}  // namespace

Expected<std::vector<Source>> make_sources(const Setup& setup) {
  SourceMaker maker;
  std::vector<Source> sources;
  for (std::size_t c = 0; c < setup.rig.cameras.size(); ++c) {
    auto source = maker.make(setup.config.cameras[c], setup.rig.cameras[c]);
    if (!source) return tl::make_unexpected(source.error());
    sources.push_back(std::move(*source));
  }
  return sources;
}

}  // namespace waymark
