#include "core/capture/image_file.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>

#include "core/base/atomic_file.h"
#include "core/capture/jpeg.h"
#include "core/capture/pgm.h"
#include "core/capture/png.h"

namespace waymark {
namespace {

/// 200 megapixels of 16-bit colour, uncompressed, take 1.2 GB.
constexpr std::size_t kMaxBytes = std::size_t{1} << 31;

enum class Format { jpeg, png, pgm };

std::optional<Format> format_of_name(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".jpg" || ending == ".jpeg") return Format::jpeg;
  if (ending == ".png") return Format::png;
  if (ending == ".pgm") return Format::pgm;
  return std::nullopt;
}

Expected<LoadedImage> decode(std::string_view bytes) {
  if (bytes.empty()) return fail(ErrorKind::bad_data, "empty file");
  if (looks_like_jpeg(bytes)) return decode_jpeg(bytes);
  if (looks_like_png(bytes)) return decode_png(bytes);
  if (looks_like_pgm(bytes)) return decode_pgm(bytes);
  return fail(ErrorKind::bad_data, "no image: neither JPEG nor PNG nor PGM");
}

Expected<std::string> encode(Format format, const GrayView& image, int jpeg_quality) {
  if (format == Format::jpeg) return encode_jpeg(image, jpeg_quality);
  if (format == Format::png) return encode_png(image);
  return encode_pgm(image);
}

/// The same error about a file.
tl::unexpected<Error> about(const std::filesystem::path& path, const Error& error) {
  return fail(error.kind, "{}: {}", path.string(), error.message);
}

}  // namespace

bool is_image_name(const std::filesystem::path& path) { return format_of_name(path).has_value(); }

Expected<LoadedImage> read_gray_image(const std::filesystem::path& path) {
  const auto bytes = read_file(path, kMaxBytes);
  if (!bytes) return tl::make_unexpected(bytes.error());
  auto loaded = decode(*bytes);
  if (!loaded) return about(path, loaded.error());
  return loaded;
}

Status write_gray_image(const std::filesystem::path& path, const GrayView& image,
                        int jpeg_quality) {
  const auto format = format_of_name(path);
  if (!format) {
    return fail(ErrorKind::usage, "{}: unknown ending; images are written as jpg, png or pgm",
                path.string());
  }
  const auto bytes = encode(*format, image, jpeg_quality);
  if (!bytes) return about(path, bytes.error());
  return write_file_atomically(path, *bytes);
}

}  // namespace waymark
