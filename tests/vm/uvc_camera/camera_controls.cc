#include "tests/vm/uvc_camera/camera_controls.h"

#include <algorithm>

#include "tests/vm/uvc_camera/usb_descriptors.h"

namespace waymark::uvc {
namespace {

constexpr std::uint32_t kAutomaticExposure = 8;  // aperture priority; 1 is manual
constexpr std::uint8_t kGetAndSet = 3;           // what GET_INFO says: both are possible

Bytes number(std::uint32_t value, std::size_t bytes) {
  Bytes all;
  put32(all, value);
  all.resize(bytes);
  return all;
}

std::uint32_t number(const Bytes& bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 4); ++i) {
    value |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  }
  return value;
}

}  // namespace

CameraControls::CameraControls()
    : controls_{
          // The automatic mode's step is the set of modes there are: manual 1, aperture priority 8.
          {"auto_exposure", kCameraTerminal, 2, 1, 1, 8, 9, kAutomaticExposure, kAutomaticExposure},
          {"exposure_100us", kCameraTerminal, 4, 4, 1, 5000, 1, 100, 100},
          {"brightness", kProcessingUnit, 2, 2, 0, 255, 1, 128, 128},
          {"gain", kProcessingUnit, 4, 2, 0, 255, 1, 16, 16},
      } {}

std::optional<Bytes> CameraControls::answer(const ControlRequest& request) {
  const auto entity = static_cast<std::uint8_t>(request.index >> 8U);
  const auto selector = static_cast<std::uint8_t>(request.value >> 8U);
  const auto found = std::find_if(controls_.begin(), controls_.end(), [&](const Control& c) {
    return c.entity == entity && c.selector == selector;
  });
  if (found == controls_.end()) return std::nullopt;
  Control& control = *found;
  switch (request.request) {
    case kSetCurrent: {
      const std::uint32_t value = number(request.data);
      if (value < control.minimum || value > control.maximum) return std::nullopt;
      control.current = value;
      return Bytes{};
    }
    case kGetCurrent:
      return number(control.current, control.bytes);
    case kGetMinimum:
      return number(control.minimum, control.bytes);
    case kGetMaximum:
      return number(control.maximum, control.bytes);
    case kGetStep:
      return number(control.step, control.bytes);
    case kGetDefault:
      return number(control.initial, control.bytes);
    case kGetLength:
      return number(control.bytes, 2);
    case kGetInfo:
      return Bytes{kGetAndSet};
    default:
      return std::nullopt;
  }
}

}  // namespace waymark::uvc
