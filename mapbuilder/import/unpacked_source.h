#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "mapbuilder/import/byte_source.h"

namespace waymark {

/// Bytes of memory, as a source.
class SpanSource : public ByteSource {
 public:
  explicit SpanSource(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] Expected<std::size_t> read(std::span<std::uint8_t> buffer) override;

 private:
  std::span<const std::uint8_t> bytes_;
};

/// Frames of zstd that ask for a larger window are refused: no recorder writes them, and each takes
/// that much memory.
inline constexpr int kMaxZstdWindowLog = 24;

/// Whether bytes begin as a frame of zstd does.
[[nodiscard]] bool looks_like_zstd(std::span<const std::uint8_t> bytes);

/// What frames of zstd or lz4 unpack to, piece by piece: memory is that of a window, whatever they
/// unpack to. `packed` must outlive the source. Its reads fail (bad_data, without a file's name)
/// where the frames are damaged or cut off, and of zstd where the window is too large.
[[nodiscard]] std::unique_ptr<ByteSource> unpacked_zstd(ByteSource& packed);
[[nodiscard]] std::unique_ptr<ByteSource> unpacked_lz4(ByteSource& packed);

/// All that frames of zstd unpack to; bad_data where that is more than `max_bytes`.
[[nodiscard]] Expected<std::vector<std::uint8_t>> unpack_zstd(std::span<const std::uint8_t> packed,
                                                              std::size_t max_bytes);

}  // namespace waymark
