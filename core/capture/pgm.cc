#include "core/capture/pgm.h"

#include <charconv>
#include <optional>

namespace waymark {
namespace {

constexpr int kMaxSide_px = 1'000'000;

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

}  // namespace

bool looks_like_pgm(std::string_view bytes) {
  return bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '7' &&
         is_blank(bytes[2]);
}

Expected<LoadedImage> decode_pgm(std::string_view bytes) {
  if (!bytes.starts_with("P5")) {
    return fail(ErrorKind::bad_data, "netpbm file of kind {}; only P5 (binary PGM) is read",
                bytes.substr(0, 2));
  }
  bytes.remove_prefix(2);
  const auto width = take_number(bytes);
  const auto height = take_number(bytes);
  const auto maximum = take_number(bytes);
  if (!width || !height || !maximum || *width < 1 || *height < 1 || *width > kMaxSide_px ||
      *height > kMaxSide_px || *maximum < 1 || *maximum > 65535 || bytes.empty() ||
      !is_blank(bytes.front())) {
    return fail(ErrorKind::bad_data, "damaged PGM header");
  }
  bytes.remove_prefix(1);
  const std::size_t count = static_cast<std::size_t>(*width) * static_cast<std::size_t>(*height);
  if (count > kMaxImagePixels) {
    return fail(ErrorKind::bad_data, "{}×{} px; more than 200 megapixels", *width, *height);
  }
  const std::size_t bytes_per_pixel = *maximum > 255 ? 2 : 1;
  if (bytes.size() < count * bytes_per_pixel) {
    return fail(ErrorKind::bad_data, "truncated PGM: {} of {} pixel bytes", bytes.size(),
                count * bytes_per_pixel);
  }
  LoadedImage loaded{GrayImage(*width, *height), false, bytes_per_pixel == 2};
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(bytes[i]); };
  const auto full = static_cast<unsigned>(*maximum);
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned value = bytes_per_pixel == 1 ? byte(i) : 256U * byte(2 * i) + byte(2 * i + 1);
    if (full == 255) {
      loaded.image.pixels[i] = static_cast<std::uint8_t>(value);
    } else {
      const unsigned scaled = full == 65535 ? value >> 8U : (255 * value + full / 2) / full;
      loaded.image.pixels[i] = static_cast<std::uint8_t>(scaled < 255 ? scaled : 255);
    }
  }
  return loaded;
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
