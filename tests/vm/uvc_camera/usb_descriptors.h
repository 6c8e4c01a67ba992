#pragma once

#include <optional>
#include <string>

#include "tests/vm/uvc_camera/camera_format.h"

namespace waymark::uvc {

inline constexpr std::uint16_t kVendor = 0x1209;   ///< pid.codes, for projects without one
inline constexpr std::uint16_t kProduct = 0x0C01;  ///< of this emulator alone
inline constexpr std::uint16_t kRelease = 0x0100;  ///< 1.0, binary-coded decimal

inline constexpr std::uint8_t kVideoClass = 0x0E;
inline constexpr std::uint8_t kControlInterface = 0;
inline constexpr std::uint8_t kStreamInterface = 1;
inline constexpr std::uint8_t kStreamEndpoint = 0x81;  ///< bulk, to the host
inline constexpr std::uint16_t kBulkPacketBytes = 512;
inline constexpr std::uint8_t kCameraTerminal = 1;
inline constexpr std::uint8_t kProcessingUnit = 2;

/// USB 2.0, table 9-8.
[[nodiscard]] Bytes device_descriptor();

/// The whole configuration: interfaces, the chain camera terminal → processing unit → output
/// terminal, one format with one frame size, one bulk endpoint (UVC 1.0, section 3).
[[nodiscard]] Bytes configuration_descriptor(const CameraFormat& format);

/// Strings that the others point to; nullopt for an index that none does.
[[nodiscard]] std::optional<Bytes> string_descriptor(std::uint8_t index,
                                                     const CameraFormat& format);

}  // namespace waymark::uvc
