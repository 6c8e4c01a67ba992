#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tests/vm/uvc_camera/camera_format.h"

namespace waymark::uvc {

/// A request on the control endpoint (USB 2.0, table 9-2).
struct ControlRequest {
  std::uint8_t type = 0;  ///< direction, kind, recipient
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;  ///< bytes that the host takes, or sends
  Bytes data;                ///< sent by the host

  [[nodiscard]] bool to_host() const { return (type & 0x80U) != 0; }
};

/// Requests of the video class (UVC 1.0, table A-8).
enum VideoRequest : std::uint8_t {
  kSetCurrent = 0x01,
  kGetCurrent = 0x81,
  kGetMinimum = 0x82,
  kGetMaximum = 0x83,
  kGetStep = 0x84,
  kGetLength = 0x85,
  kGetInfo = 0x86,
  kGetDefault = 0x87,
};

/// What can be set about the picture. It does not change the pixels that are sent: tests look at
/// what a program set.
class CameraControls {
 public:
  struct Control {
    const char* name;
    std::uint8_t entity;    ///< terminal or unit
    std::uint8_t selector;  ///< of the control within it
    std::uint8_t bytes;
    std::uint32_t minimum, maximum, step, initial;
    std::uint32_t current;
  };

  CameraControls();

  /// The answer's bytes; nullopt refuses (a stall).
  [[nodiscard]] std::optional<Bytes> answer(const ControlRequest& request);

  [[nodiscard]] const std::vector<Control>& all() const { return controls_; }

 private:
  std::vector<Control> controls_;
};

}  // namespace waymark::uvc
