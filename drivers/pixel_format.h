#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/capture/gray_image.h"

namespace waymark {

/// One of the pixel formats that grey images are made of.
struct PixelFormat {
  enum class Kind {
    luma_first,  ///< rows of 8-bit luma lie at the buffer's start: used where they are
    luma_pairs,  ///< 16 bit per pixel, of which 8 are luma
    deep,        ///< 16 bit per pixel, little-endian, of which the lower `bits` count
    jpeg,        ///< one JPEG per frame
  };

  std::uint32_t fourcc;   ///< V4L2_PIX_FMT_…
  std::string_view name;  ///< in locd.toml and messages
  Kind kind;
  int bytes_per_pixel;  ///< of a row; 0 of compressed ones
  int bits;             ///< of luma_pairs, the luma's shift within the pair
};

/// All of them, the best first: uncopied, then uncompressed, then the rest.
[[nodiscard]] std::span<const PixelFormat> pixel_formats();
/// Null when it is none of them. "MJPEG" is MJPG.
[[nodiscard]] const PixelFormat* find_pixel_format(std::string_view name);
[[nodiscard]] const PixelFormat* find_pixel_format(std::uint32_t fourcc);
/// The four letters, for messages about formats that are none of them.
[[nodiscard]] std::string fourcc_text(std::uint32_t fourcc);

/// Turns a frame of any other kind into `image`, whose size says what is expected. bad_data for a
/// JPEG that is damaged, truncated or of another size; buffers of the other kinds are as large as
/// height·stride.
[[nodiscard]] Status convert_to_gray(const PixelFormat& format, std::span<const std::uint8_t> bytes,
                                     std::size_t stride_bytes, GrayImage& image);

}  // namespace waymark
