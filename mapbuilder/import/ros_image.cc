#include "mapbuilder/import/ros_image.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/capture/jpeg.h"
#include "core/capture/png.h"

namespace waymark {
namespace {

/// How a pixel becomes grey.
enum class Pixels { grey, rgb, bgr, bayer };

struct Encoding {
  std::string_view name;
  Pixels pixels;
  std::uint32_t bytes_per_sample;
  std::uint32_t samples;  ///< from pixel to pixel
  std::uint32_t first;    ///< sample of a pixel's that is looked at
};

constexpr std::array<Encoding, 28> kEncodings{{
    {"mono8", Pixels::grey, 1, 1, 0},        {"8UC1", Pixels::grey, 1, 1, 0},
    {"mono16", Pixels::grey, 2, 1, 0},       {"16UC1", Pixels::grey, 2, 1, 0},
    {"rgb8", Pixels::rgb, 1, 3, 0},          {"bgr8", Pixels::bgr, 1, 3, 0},
    {"8UC3", Pixels::bgr, 1, 3, 0},          {"rgba8", Pixels::rgb, 1, 4, 0},
    {"bgra8", Pixels::bgr, 1, 4, 0},         {"8UC4", Pixels::bgr, 1, 4, 0},
    {"rgb16", Pixels::rgb, 2, 3, 0},         {"bgr16", Pixels::bgr, 2, 3, 0},
    {"16UC3", Pixels::bgr, 2, 3, 0},         {"rgba16", Pixels::rgb, 2, 4, 0},
    {"bgra16", Pixels::bgr, 2, 4, 0},        {"16UC4", Pixels::bgr, 2, 4, 0},
    {"bayer_rggb8", Pixels::bayer, 1, 1, 0}, {"bayer_rggb16", Pixels::bayer, 2, 1, 0},
    {"bayer_bggr8", Pixels::bayer, 1, 1, 0}, {"bayer_bggr16", Pixels::bayer, 2, 1, 0},
    {"bayer_gbrg8", Pixels::bayer, 1, 1, 0}, {"bayer_gbrg16", Pixels::bayer, 2, 1, 0},
    {"bayer_grbg8", Pixels::bayer, 1, 1, 0}, {"bayer_grbg16", Pixels::bayer, 2, 1, 0},
    {"yuv422", Pixels::grey, 1, 2, 1},       {"uyvy", Pixels::grey, 1, 2, 1},
    {"yuv422_yuy2", Pixels::grey, 1, 2, 0},  {"yuyv", Pixels::grey, 1, 2, 0},
}};

const Encoding* encoding_of(std::string_view name) {
  const auto found = std::find_if(kEncodings.begin(), kEncodings.end(),
                                  [&](const Encoding& e) { return e.name == name; });
  return found == kEncodings.end() ? nullptr : &*found;
}

/// Rec. 601, weights in thousandths, of sums of `times` values each, rounded.
std::uint32_t luma(std::uint32_t red, std::uint32_t green, std::uint32_t blue,
                   std::uint32_t times) {
  const std::uint32_t all = 1000 * times;
  return (299 * red + 587 * green + 114 * blue + all / 2) / all;
}

/// The samples of an image, whatever their size and byte order.
class Samples {
 public:
  Samples(const RosImage& image, const Encoding& encoding)
      : image_(image), encoding_(encoding), wide_(encoding.bytes_per_sample == 2) {}

  [[nodiscard]] std::uint32_t at(std::uint32_t x, std::uint32_t y, std::uint32_t sample = 0) const {
    const std::size_t index = std::size_t{x} * encoding_.samples + encoding_.first + sample;
    const std::size_t at = std::size_t{y} * image_.step_bytes + index * encoding_.bytes_per_sample;
    if (!wide_) return image_.data[at];
    const std::uint32_t first = image_.data[at];
    const std::uint32_t second = image_.data[at + 1];
    return image_.big_endian ? first << 8U | second : second << 8U | first;
  }

 private:
  const RosImage& image_;
  const Encoding& encoding_;
  bool wide_;
};

/// What a bayer pattern's pixels are: its name has the colours of the first row's first two pixels,
/// then of the second's.
class BayerLuma {
 public:
  BayerLuma(const Samples& samples, const RosImage& image)
      : samples_(samples),
        pattern_(std::string_view(image.encoding).substr(6, 4)),
        width_(image.width_px),
        height_(image.height_px) {}

  [[nodiscard]] std::uint32_t at(std::uint32_t x, std::uint32_t y) const {
    const std::uint32_t left = x > 0 ? x - 1 : 1;
    const std::uint32_t right = x + 1 < width_ ? x + 1 : x - 1;
    const std::uint32_t above = y > 0 ? y - 1 : 1;
    const std::uint32_t below = y + 1 < height_ ? y + 1 : y - 1;
    const std::uint32_t own = 4 * samples_.at(x, y);
    const std::uint32_t beside = samples_.at(left, y) + samples_.at(right, y);
    const std::uint32_t over = samples_.at(x, above) + samples_.at(x, below);
    if (colour(x, y) == 'g') {
      return colour(x + 1, y) == 'r' ? luma(2 * beside, own, 2 * over, 4)
                                     : luma(2 * over, own, 2 * beside, 4);
    }
    const std::uint32_t corners = samples_.at(left, above) + samples_.at(right, above) +
                                  samples_.at(left, below) + samples_.at(right, below);
    return colour(x, y) == 'r' ? luma(own, beside + over, corners, 4)
                               : luma(corners, beside + over, own, 4);
  }

 private:
  [[nodiscard]] char colour(std::uint32_t x, std::uint32_t y) const {
    return pattern_[2 * (y % 2) + x % 2];
  }

  const Samples& samples_;
  std::string_view pattern_;
  std::uint32_t width_;
  std::uint32_t height_;
};

/// Appends every pixel's value, the higher byte first where there are two.
template <typename Value>
void append_pixels(const RosImage& image, bool wide, const Value& value, std::string& pgm) {
  std::size_t at = pgm.size();
  pgm.resize(at + std::size_t{image.width_px} * image.height_px * (wide ? 2 : 1));
  for (std::uint32_t y = 0; y < image.height_px; ++y) {
    for (std::uint32_t x = 0; x < image.width_px; ++x) {
      const std::uint32_t grey = value(x, y);
      if (wide) pgm[at++] = static_cast<char>(grey >> 8U);
      pgm[at++] = static_cast<char>(grey & 255U);
    }
  }
}

Status check(const RosImage& image, const Encoding& encoding) {
  if (image.width_px == 0 || image.height_px == 0) {
    return fail(ErrorKind::bad_data, "{}×{} pixels", image.width_px, image.height_px);
  }
  if (auto fits = check_image_size({image.width_px, image.height_px}, std::nullopt); !fits) {
    return fits;
  }
  const std::uint64_t row =
      std::uint64_t{image.width_px} * encoding.samples * encoding.bytes_per_sample;
  const std::uint64_t needed = std::uint64_t{image.step_bytes} * (image.height_px - 1) + row;
  if (image.step_bytes < row || image.data.size() < needed) {
    return fail(ErrorKind::bad_data, "{} bytes for {}×{} pixels of {} in rows of {} bytes",
                image.data.size(), image.width_px, image.height_px, image.encoding,
                image.step_bytes);
  }
  if (encoding.pixels == Pixels::bayer && (image.width_px < 2 || image.height_px < 2)) {
    return fail(ErrorKind::bad_data, "{}×{} pixels of {}", image.width_px, image.height_px,
                image.encoding);
  }
  return {};
}

}  // namespace

bool is_known_encoding(std::string_view encoding) { return encoding_of(encoding) != nullptr; }

Expected<std::string> pgm_of_ros_image(const RosImage& image) {
  const Encoding* const encoding = encoding_of(image.encoding);
  if (encoding == nullptr) {
    return fail(ErrorKind::bad_data, "its encoding \"{}\" is not read", image.encoding);
  }
  if (auto fits = check(image, *encoding); !fits) return tl::make_unexpected(fits.error());
  const Samples samples(image, *encoding);
  const bool wide = encoding->bytes_per_sample == 2;
  std::string pgm =
      fmt::format("P5\n{} {}\n{}\n", image.width_px, image.height_px, wide ? 65535 : 255);
  switch (encoding->pixels) {
    case Pixels::grey:
      append_pixels(
          image, wide, [&](auto x, auto y) { return samples.at(x, y); }, pgm);
      break;
    case Pixels::rgb:
    case Pixels::bgr: {
      const std::uint32_t red = encoding->pixels == Pixels::rgb ? 0 : 2;
      const auto grey = [&](auto x, auto y) {
        return luma(samples.at(x, y, red), samples.at(x, y, 1), samples.at(x, y, 2 - red), 1);
      };
      append_pixels(image, wide, grey, pgm);
      break;
    }
    case Pixels::bayer: {
      const BayerLuma bayer(samples, image);
      append_pixels(
          image, wide, [&](auto x, auto y) { return bayer.at(x, y); }, pgm);
      break;
    }
  }
  return pgm;
}

Expected<CompressedKind> kind_of_compressed(const RosCompressedImage& image) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes of a file
  const std::string_view bytes(reinterpret_cast<const char*>(image.data.data()), image.data.size());
  const bool jpeg = looks_like_jpeg(bytes);
  if (!jpeg && !looks_like_png(bytes)) {
    return fail(ErrorKind::bad_data, "neither JPEG nor PNG: its format is \"{}\"", image.format);
  }
  const auto size = jpeg ? jpeg_size(bytes) : png_size(bytes);
  if (!size) return tl::make_unexpected(size.error());
  if (size->width_px < 1 || size->height_px < 1) {
    return fail(ErrorKind::bad_data, "damaged or truncated in its header");
  }
  if (auto fits = check_image_size(*size, std::nullopt); !fits) {
    return tl::make_unexpected(fits.error());
  }
  return CompressedKind{jpeg ? "jpg" : "png", *size};
}

}  // namespace waymark
