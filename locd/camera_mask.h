#pragma once

#include <cstddef>
#include <cstdint>

namespace waymark {

/// Cameras that one rig may have: frame sets name theirs in 32 bits, and results hold them without
/// allocation.
inline constexpr std::size_t kMaxCameras = 16;

/// Cameras by the bits of a number: bit c is camera c.
using CameraMask = std::uint32_t;
[[nodiscard]] constexpr CameraMask camera_bit(std::size_t camera) {
  return CameraMask{1} << camera;
}

}  // namespace waymark
