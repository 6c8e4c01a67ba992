#include "core/capture/png.h"

#include <zlib.h>

#include "tests/fuzz/format.h"
#include "tests/fuzz/image_format.h"
#include "tests/support/libpng_image.h"

namespace waymark::test {
namespace {

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = at; i < at + 4; ++i) {
    number = number << 8U | static_cast<unsigned char>(bytes[i]);
  }
  return number;
}

/// With the checksum that each chunk ought to have: what damages a chunk is to reach its reader.
std::string with_checksums(std::string bytes) {
  constexpr std::size_t kSignature = 8;
  constexpr std::size_t kFrame = 12;  // length, type and checksum
  for (std::size_t at = kSignature; at + kFrame <= bytes.size();) {
    const std::size_t length = number_at(bytes, at);
    if (length > bytes.size() - at - kFrame) break;
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): zlib's bytes are unsigned
    const auto* const type = reinterpret_cast<const Bytef*>(bytes.data()) + at + 4;
    const auto checksum = static_cast<std::uint32_t>(crc32(0, type, static_cast<uInt>(length + 4)));
    at += kFrame + length;
    for (unsigned i = 0; i < 4; ++i) {
      bytes[at - 1 - i] = static_cast<char>(checksum >> (8 * i));
    }
  }
  return bytes;
}

Expected<LoadedImage> read(const std::string& bytes) {
  (void)read_image(with_checksums(bytes), png_size, decode_png);
  return read_image(bytes, png_size, decode_png);
}

const AddFormat png({"Png",
                     {encode_png(image_seed().view()).value(),
                      libpng_png(PNG_COLOR_TYPE_GRAY, 16, PNG_INTERLACE_NONE),
                      libpng_png(PNG_COLOR_TYPE_RGB_ALPHA, 8, PNG_INTERLACE_ADAM7),
                      libpng_png(PNG_COLOR_TYPE_PALETTE, 2, PNG_INTERLACE_ADAM7)},
                     {"IHDR", "PLTE", "IDAT", "IEND", "tRNS", "gAMA", "iCCP",
                      "eXIf", "zTXt", "iTXt", "tEXt", "sBIT", "sRGB", "cHRM",
                      "pHYs", "hIST", "bKGD", "sPLT", "tIME", "oFFs"},
                     reader(read)});

}  // namespace
}  // namespace waymark::test
