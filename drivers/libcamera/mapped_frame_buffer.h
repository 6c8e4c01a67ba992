#pragma once

#include <libcamera/framebuffer.h>
#include <sys/mman.h>

#include <cstdint>
#include <memory>

namespace waymark {

/// The first plane of a buffer, readable until the last owner lets go, also after the camera is
/// closed; null, with errno, when it can't be mapped.
[[nodiscard]] inline std::shared_ptr<const std::uint8_t> map_first_plane(
    const libcamera::FrameBuffer& buffer) {
  const libcamera::FrameBuffer::Plane& plane = buffer.planes().front();
  // Offsets need not lie on a page's border: mapped from the start.
  const std::size_t length = std::size_t{plane.offset} + plane.length;
  void* const memory = ::mmap(nullptr, length, PROT_READ, MAP_SHARED, plane.fd.get(), 0);
  if (memory == MAP_FAILED) return nullptr;  // NOLINT: the system's own macro
  return {static_cast<const std::uint8_t*>(memory) + plane.offset,
          [memory, length](const std::uint8_t* /*plane*/) { ::munmap(memory, length); }};
}

}  // namespace waymark
