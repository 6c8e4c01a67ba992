#include "drivers/pixel_format.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>

#include "core/base/check.h"
#include "core/capture/jpeg.h"

namespace waymark {
namespace {

using Kind = PixelFormat::Kind;

constexpr std::array<PixelFormat, 9> kFormats{{
    {V4L2_PIX_FMT_GREY, "GREY", Kind::luma_first, 1, 8},
    {V4L2_PIX_FMT_NV12, "NV12", Kind::luma_first, 1, 8},
    {V4L2_PIX_FMT_NV12M, "NV12M", Kind::luma_first, 1, 8},
    {V4L2_PIX_FMT_YUYV, "YUYV", Kind::luma_pairs, 2, 0},
    {V4L2_PIX_FMT_UYVY, "UYVY", Kind::luma_pairs, 2, 8},
    {V4L2_PIX_FMT_Y16, "Y16", Kind::deep, 2, 16},
    {V4L2_PIX_FMT_Y12, "Y12", Kind::deep, 2, 12},
    {V4L2_PIX_FMT_Y10, "Y10", Kind::deep, 2, 10},
    {V4L2_PIX_FMT_MJPEG, "MJPG", Kind::jpeg, 0, 8},
}};

/// The 8 bits from `shift` on of every little-endian pair of bytes.
void take_bits(const std::uint8_t* bytes, std::size_t stride_bytes, int shift, GrayImage& image) {
  for (int y = 0; y < image.height_px; ++y) {
    const std::uint8_t* from = bytes + static_cast<std::size_t>(y) * stride_bytes;
    std::uint8_t* to = image.row(y);
    for (int x = 0; x < image.width_px; ++x, from += 2) {
      const unsigned pair = from[0] | static_cast<unsigned>(from[1]) << 8;
      to[x] = static_cast<std::uint8_t>(pair >> shift);
    }
  }
}

}  // namespace

std::span<const PixelFormat> pixel_formats() { return kFormats; }

const PixelFormat* find_pixel_format(std::string_view name) {
  if (name == "MJPEG") name = "MJPG";
  const auto* const found = std::find_if(kFormats.begin(), kFormats.end(),
                                         [&](const PixelFormat& f) { return f.name == name; });
  return found == kFormats.end() ? nullptr : found;
}

const PixelFormat* find_pixel_format(std::uint32_t fourcc) {
  const auto* const found = std::find_if(kFormats.begin(), kFormats.end(),
                                         [&](const PixelFormat& f) { return f.fourcc == fourcc; });
  return found == kFormats.end() ? nullptr : found;
}

std::string fourcc_text(std::uint32_t fourcc) {
  std::string text;
  for (int shift = 0; shift < 32; shift += 8) {
    const char letter = static_cast<char>(fourcc >> shift & 0x7FU);
    text += letter >= ' ' && letter < 127 ? letter : '?';
  }
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

Status convert_to_gray(const PixelFormat& format, std::span<const std::uint8_t> bytes,
                       std::size_t stride_bytes, GrayImage& image) {
  if (format.kind == Kind::jpeg) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): a JPEG as it comes off the wire
    return decode_jpeg_into({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, image);
  }
  WAYMARK_CHECK(format.kind != Kind::luma_first);
  WAYMARK_CHECK(bytes.size() + stride_bytes >=
                stride_bytes * static_cast<std::size_t>(image.height_px) +
                    2 * static_cast<std::size_t>(image.width_px));
  const int shift = format.kind == Kind::luma_pairs ? format.bits : format.bits - 8;
  take_bits(bytes.data(), stride_bytes, shift, image);
  return {};
}

}  // namespace waymark
