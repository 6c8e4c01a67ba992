#include "core/capture/image_file.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "core/base/atomic_file.h"
#include "core/base/text_field.h"
#include "core/capture/foreign_format.h"
#include "core/capture/jpeg.h"
#include "core/capture/pgm.h"
#include "core/capture/png.h"

namespace waymark {
namespace {

/// No format takes more: 16-bit colour with alpha, uncompressed, and what else a file may hold.
std::size_t largest_file(ImageSize size) {
  constexpr std::int64_t kBytesPerPixel = 8;
  constexpr std::int64_t kRest = std::int64_t{1} << 20;
  const std::int64_t pixels = std::min(size.width_px * size.height_px, kMaxImagePixels);
  return static_cast<std::size_t>(kBytesPerPixel * pixels + kRest);
}

/// Of an image of which nothing is known.
constexpr ImageSize kLargestImage{kMaxImagePixels, 1};

enum class Format { jpeg, png, pgm };

std::optional<Format> format_of_name(const std::filesystem::path& path) {
  const std::string ending = lower_case(path.extension().string());
  if (ending == ".jpg" || ending == ".jpeg") return Format::jpeg;
  if (ending == ".png") return Format::png;
  if (ending == ".pgm") return Format::pgm;
  return std::nullopt;
}

/// What reads one format.
struct Codec {
  bool (*looks_like)(std::string_view);
  Expected<ImageSize> (*size)(std::string_view);
  Expected<LoadedImage> (*decode)(std::string_view, std::optional<ImageSize>);
};

constexpr std::array<Codec, 3> kCodecs{{{looks_like_jpeg, jpeg_size, decode_jpeg},
                                        {looks_like_png, png_size, decode_png},
                                        {looks_like_pgm, pgm_size, decode_pgm}}};

/// By what the bytes begin with.
Expected<Codec> codec_of(std::string_view bytes) {
  if (bytes.empty()) return fail(ErrorKind::bad_data, "empty file");
  for (const Codec& codec : kCodecs) {
    if (codec.looks_like(bytes)) return codec;
  }
  if (const auto format = foreign_format_of_content(bytes); !format.empty()) {
    return fail(Cause::format, "a {} image, which is not read; convert it to PNG", format);
  }
  return fail(ErrorKind::bad_data, "no image: neither JPEG nor PNG nor PGM");
}

Expected<std::string> encode(Format format, const GrayView& image, int jpeg_quality) {
  if (format == Format::jpeg) return encode_jpeg(image, jpeg_quality);
  if (format == Format::png) return encode_png(image);
  return encode_pgm(image);
}

/// The same error about a file.
tl::unexpected<Error> about(const std::filesystem::path& path, const Error& error) {
  Error named{error.kind, fmt::format("{}: {}", path.string(), error.message)};
  named.cause = error.cause;
  return tl::make_unexpected(std::move(named));
}

}  // namespace

bool is_image_name(const std::filesystem::path& path) { return format_of_name(path).has_value(); }

Expected<LoadedImage> read_gray_image(const std::filesystem::path& path,
                                      std::optional<ImageSize> expected) {
  const auto bytes = read_file(path, largest_file(expected.value_or(kLargestImage)));
  if (!bytes) return tl::make_unexpected(bytes.error());
  const auto codec = codec_of(*bytes);
  if (!codec) return about(path, codec.error());
  auto loaded = codec->decode(*bytes, expected);
  if (!loaded) return about(path, loaded.error());
  return loaded;
}

Expected<ImageSize> read_image_size(const std::filesystem::path& path) {
  const auto bytes = read_file(path, largest_file(kLargestImage));
  if (!bytes) return tl::make_unexpected(bytes.error());
  const auto codec = codec_of(*bytes);
  if (!codec) return about(path, codec.error());
  auto size = codec->size(*bytes);
  if (!size) return about(path, size.error());
  return size;
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
