#include "drivers/libcamera/camera_settings.h"

#include <fmt/ranges.h>
#include <libcamera/control_ids.h>
#include <libcamera/formats.h>
#include <libcamera/property_ids.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace waymark {
namespace {

namespace controls = libcamera::controls;

/// libcamera's name of each of our formats that it knows.
const libcamera::PixelFormat* of_libcamera(const PixelFormat& format) {
  static const std::array<std::pair<std::string_view, libcamera::PixelFormat>, 7> kNames{{
      {"GREY", libcamera::formats::R8},
      {"NV12", libcamera::formats::NV12},
      {"YUYV", libcamera::formats::YUYV},
      {"UYVY", libcamera::formats::UYVY},
      {"Y12", libcamera::formats::R12},
      {"Y10", libcamera::formats::R10},
      {"MJPG", libcamera::formats::MJPEG},
  }};
  const auto* const found = std::find_if(
      kNames.begin(), kNames.end(), [&](const auto& entry) { return entry.first == format.name; });
  return found == kNames.end() ? nullptr : &found->second;
}

const PixelFormat* choose_pixels(const libcamera::StreamConfiguration& stream,
                                 const CaptureRequest& request) {
  const libcamera::Size wanted(static_cast<unsigned>(request.width_px),
                               static_cast<unsigned>(request.height_px));
  const auto offered = stream.formats().pixelformats();
  const PixelFormat* of_another_size = nullptr;
  for (const PixelFormat& format : pixel_formats()) {
    if (request.pixels != nullptr && request.pixels != &format) continue;
    const libcamera::PixelFormat* const theirs = of_libcamera(format);
    if (theirs == nullptr) continue;
    if (std::find(offered.begin(), offered.end(), *theirs) == offered.end()) continue;
    const auto sizes = stream.formats().sizes(*theirs);
    if (std::find(sizes.begin(), sizes.end(), wanted) != sizes.end()) return &format;
    if (of_another_size == nullptr) of_another_size = &format;
  }
  return of_another_size;
}

/// Sets controls of one camera, as far as it has them.
class ControlSetter {
 public:
  ControlSetter(const libcamera::ControlInfoMap& can, const std::string& name)
      : can_(can), name_(name), list_(can) {}

  /// An automatism goes off where there is one.
  template <typename Control, typename Value>
  void set_if_there(const Control& control, const Value& value) {
    if (can_.find(&control) != can_.end()) list_.set(control, value);
  }

  /// `value` of what `key` names in locd.toml.
  template <typename T>
  Status set(std::string_view key, const libcamera::Control<T>& control,
             const std::optional<double>& value) {
    if (!value) return {};
    const auto info = can_.find(&control);
    if (info == can_.end()) return no_such_control(key, *value);
    const auto low = static_cast<double>(info->second.min().template get<T>());
    const auto high = static_cast<double>(info->second.max().template get<T>());
    if (*value < low || *value > high) {
      return fail(ErrorKind::config, "{}: {} = {} can't be set; the camera takes {} to {}", name_,
                  key, *value, low, high);
    }
    list_.set(control, static_cast<T>(std::is_integral_v<T> ? std::round(*value) : *value));
    return {};
  }

  Status set_rate(double fps) {
    if (fps == 0) return {};
    if (can_.find(&controls::FrameDurationLimits) == can_.end()) return no_such_control("fps", fps);
    const std::array<std::int64_t, 2> limits{std::llround(1e6 / fps), std::llround(1e6 / fps)};
    list_.set(controls::FrameDurationLimits, libcamera::Span<const std::int64_t, 2>(limits));
    return {};
  }

  [[nodiscard]] Status no_such_control(std::string_view key, double value) const {
    return fail(ErrorKind::config,
                "{}: {} = {}: libcamera has no such control of this camera; leave it out", name_,
                key, value);
  }
  [[nodiscard]] libcamera::ControlList take() { return std::move(list_); }

 private:
  const libcamera::ControlInfoMap& can_;
  const std::string& name_;
  libcamera::ControlList list_;
};

}  // namespace

Expected<StreamSettings> stream_settings(libcamera::Camera& camera, const CaptureRequest& request) {
  StreamSettings settings;
  settings.configuration = camera.generateConfiguration({libcamera::StreamRole::Viewfinder});
  if (settings.configuration == nullptr || settings.configuration->empty()) {
    return fail(ErrorKind::config, "{}: offers no stream", camera.id());
  }
  libcamera::StreamConfiguration& stream = settings.configuration->at(0);
  const PixelFormat* const pixels = choose_pixels(stream, request);
  if (pixels == nullptr) {
    return fail(ErrorKind::config, "{}: does not deliver {}; it offers {}", camera.id(),
                request.pixels != nullptr ? request.pixels->name : "any format that is understood",
                offered_formats(camera));
  }
  const libcamera::Size size(static_cast<unsigned>(request.width_px),
                             static_cast<unsigned>(request.height_px));
  stream.pixelFormat = *of_libcamera(*pixels);
  stream.size = size;
  stream.bufferCount = FrameMaker::kBuffers;
  if (settings.configuration->validate() == libcamera::CameraConfiguration::Invalid ||
      stream.pixelFormat != *of_libcamera(*pixels) || stream.size != size) {
    return fail(ErrorKind::config,
                "{}: {} {}×{} px is wanted (rig.yaml's resolution), the camera gives {}; it offers "
                "{}",
                camera.id(), pixels->name, request.width_px, request.height_px, stream.toString(),
                offered_formats(camera));
  }
  settings.layout = {pixels, request.width_px, request.height_px, stream.stride};
  return settings;
}

std::string offered_formats(libcamera::Camera& camera) {
  const auto configuration = camera.generateConfiguration({libcamera::StreamRole::Viewfinder});
  if (configuration == nullptr || configuration->empty()) return "nothing";
  const libcamera::StreamFormats& formats = configuration->at(0).formats();
  std::vector<std::string> all;
  for (const libcamera::PixelFormat& format : formats.pixelformats()) {
    std::vector<std::string> sizes;
    for (const libcamera::Size& size : formats.sizes(format)) {
      sizes.push_back(fmt::format("{}×{}", size.width, size.height));
    }
    const auto known = pixel_formats();
    const auto ours = std::find_if(known.begin(), known.end(), [&](const PixelFormat& candidate) {
      const libcamera::PixelFormat* const theirs = of_libcamera(candidate);
      return theirs != nullptr && *theirs == format;
    });
    all.push_back(fmt::format("{} {}",
                              ours == known.end() ? format.toString() : std::string(ours->name),
                              fmt::join(sizes, ", ")));
  }
  return fmt::format("{}", fmt::join(all, "; "));
}

std::vector<OfferedFormat> understood_formats(libcamera::Camera& camera) {
  std::vector<OfferedFormat> understood;
  const auto configuration = camera.generateConfiguration({libcamera::StreamRole::Viewfinder});
  if (configuration == nullptr || configuration->empty()) return understood;
  const libcamera::StreamFormats& formats = configuration->at(0).formats();
  for (const PixelFormat& format : pixel_formats()) {
    const libcamera::PixelFormat* const theirs = of_libcamera(format);
    if (theirs == nullptr) continue;
    for (const libcamera::Size& size : formats.sizes(*theirs)) {
      understood.push_back({&format, static_cast<int>(size.width), static_cast<int>(size.height)});
    }
  }
  return understood;
}

Expected<libcamera::ControlList> start_controls(const libcamera::ControlInfoMap& offered,
                                                const CameraOptions& options) {
  const CameraControls& wanted = options.controls;
  ControlSetter setter(offered, options.name);
  if (wanted.exposure_us || wanted.gain) setter.set_if_there(controls::AeEnable, false);
  setter.set_if_there(controls::AfMode, static_cast<std::int32_t>(controls::AfModeManual));
  Status set = setter.set("exposure_us", controls::ExposureTime, wanted.exposure_us);
  if (set) set = setter.set("gain", controls::AnalogueGain, wanted.gain);
  if (set) set = setter.set("focus", controls::LensPosition, wanted.focus);
  if (set) set = setter.set_rate(options.request.fps);
  // Version 0.0.3 has neither.
  if (set && wanted.white_balance_k) {
    set = setter.no_such_control("white_balance_k", *wanted.white_balance_k);
  }
  if (set && wanted.power_line_hz) {
    set = setter.no_such_control("power_line_hz", *wanted.power_line_hz);
  }
  if (!set) return tl::make_unexpected(set.error());
  return setter.take();
}

StampMeaning stamp_meaning(const libcamera::ControlList& metadata) {
  return metadata.contains(controls::SensorTimestamp.id()) ? StampMeaning::start_of_exposure
                                                           : StampMeaning::unknown;
}

Stamp exposure_of(const libcamera::ControlList& metadata, Stamp otherwise) {
  const auto exposure_us = metadata.get(controls::ExposureTime);
  return exposure_us ? from_us(*exposure_us) : otherwise;
}

Status check_crop(const std::string& camera, const libcamera::ControlList& metadata,
                  const libcamera::ControlList& properties) {
  const auto crop = metadata.get(controls::ScalerCrop);
  const auto whole = properties.get(libcamera::properties::ScalerCropMaximum);
  if (!crop || !whole || *crop == *whole) return {};
  return fail(ErrorKind::config,
              "{}: crops {} where the whole image is {}: another image than the calibrated one; "
              "choose a resolution of the sensor's own shape",
              camera, crop->toString(), whole->toString());
}

}  // namespace waymark
