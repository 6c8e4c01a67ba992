#include "core/capture/pgm.h"

#include <algorithm>
#include <bit>
#include <charconv>

#include "core/capture/pixel_depth.h"

namespace waymark {
namespace {

constexpr int kMaxSide_px = 1'000'000;
/// Says nothing of how many bits are in use.
constexpr int kFullMaximum = 65535;

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Takes one number of the header off the front, with the blanks and comments before it.
std::optional<int> take_number(std::string_view& bytes) {
  while (!bytes.empty() && (is_blank(bytes.front()) || bytes.front() == '#')) {
    if (bytes.front() != '#') {
      bytes.remove_prefix(1);
      continue;
    }
    const auto end_of_line = bytes.find('\n');
    bytes.remove_prefix(end_of_line == std::string_view::npos ? bytes.size() : end_of_line);
  }
  int number = 0;
  const auto [end, error] = std::from_chars(bytes.data(), bytes.data() + bytes.size(), number);
  if (error != std::errc{}) return std::nullopt;
  bytes.remove_prefix(static_cast<std::size_t>(end - bytes.data()));
  return number;
}

struct Header {
  ImageSize size;
  int maximum = 0;
};

/// Takes the header off the front, with the one blank behind it.
Expected<Header> take_header(std::string_view& bytes) {
  if (!bytes.starts_with("P5")) {
    return fail(ErrorKind::bad_data, "netpbm file of kind {}; only P5 (binary PGM) is read",
                bytes.substr(0, 2));
  }
  bytes.remove_prefix(2);
  const auto width = take_number(bytes);
  const auto height = take_number(bytes);
  const auto maximum = take_number(bytes);
  if (!width || !height || !maximum || *width < 1 || *height < 1 || *width > kMaxSide_px ||
      *height > kMaxSide_px || *maximum < 1 || *maximum > kFullMaximum || bytes.empty() ||
      !is_blank(bytes.front())) {
    return fail(ErrorKind::bad_data, "damaged PGM header");
  }
  bytes.remove_prefix(1);
  return Header{{*width, *height}, *maximum};
}

/// The stored value of every pixel is `value(i)`, `maximum` is white.
template <typename Value>
LoadedImage scaled_by(int maximum, int width, int height, const Value& value) {
  LoadedImage loaded{GrayImage(width, height), false, {}};
  const auto full = static_cast<unsigned>(maximum);
  unsigned largest = 0;
  for (std::size_t i = 0; i < loaded.image.pixels.size(); ++i) {
    const unsigned stored = value(i);
    largest = std::max(largest, stored);
    const unsigned scaled = full == 255 ? stored : (255 * stored + full / 2) / full;
    loaded.image.pixels[i] = static_cast<std::uint8_t>(scaled < 255 ? scaled : 255);
  }
  if (maximum > 255) {
    loaded.deep = DeepPixels{static_cast<int>(largest), static_cast<int>(std::bit_width(full))};
  }
  return loaded;
}

/// The upper 8 of the bits in use.
template <typename Value>
LoadedImage upper_bits(int width, int height, const Value& value) {
  LoadedImage loaded{GrayImage(width, height), false, DeepPixels{}};
  unsigned largest = 0;
  for (std::size_t i = 0; i < loaded.image.pixels.size(); ++i)
    largest = std::max(largest, value(i));
  loaded.deep = DeepPixels{static_cast<int>(largest), bits_in_use(static_cast<int>(largest))};
  const int shift = loaded.deep->bits_in_use - 8;
  for (std::size_t i = 0; i < loaded.image.pixels.size(); ++i) {
    loaded.image.pixels[i] = static_cast<std::uint8_t>(value(i) >> shift);
  }
  return loaded;
}

}  // namespace

bool looks_like_pgm(std::string_view bytes) {
  return bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '7' &&
         is_blank(bytes[2]);
}

Expected<ImageSize> pgm_size(std::string_view bytes) {
  const auto header = take_header(bytes);
  if (!header) return tl::make_unexpected(header.error());
  return header->size;
}

Expected<LoadedImage> decode_pgm(std::string_view bytes, std::optional<ImageSize> expected) {
  const auto header = take_header(bytes);
  if (!header) return tl::make_unexpected(header.error());
  if (auto fits = check_image_size(header->size, expected); !fits) {
    return tl::make_unexpected(fits.error());
  }
  const auto width = static_cast<int>(header->size.width_px);
  const auto height = static_cast<int>(header->size.height_px);
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const std::size_t bytes_per_pixel = header->maximum > 255 ? 2 : 1;
  if (bytes.size() < count * bytes_per_pixel) {
    return fail(ErrorKind::bad_data, "truncated PGM: {} of {} pixel bytes", bytes.size(),
                count * bytes_per_pixel);
  }
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(bytes[i]); };
  const auto pair = [&](std::size_t i) { return 256U * byte(2 * i) + byte(2 * i + 1); };
  if (header->maximum == kFullMaximum) return upper_bits(width, height, pair);
  if (bytes_per_pixel == 2) return scaled_by(header->maximum, width, height, pair);
  return scaled_by(header->maximum, width, height, byte);
}

std::string encode_pgm(const GrayView& image) {
  std::string bytes = fmt::format("P5\n{} {}\n255\n", image.width_px, image.height_px);
  for (int y = 0; y < image.height_px; ++y) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): grey values are bytes of the
    // file
    bytes.append(reinterpret_cast<const char*>(image.row(y)),
                 static_cast<std::size_t>(image.width_px));
  }
  return bytes;
}

}  // namespace waymark
