#include "core/capture/jpeg.h"

#include <turbojpeg.h>

#include <memory>

#include "core/base/check.h"
#include "core/capture/jpeg_segments.h"

namespace waymark {
namespace {

constexpr int kMostScans = 20;
/// libjpeg's default transform, the only one that is exact to the bit everywhere.
constexpr int kFlags = TJFLAG_ACCURATEDCT;

struct HandleDeleter {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Handle = std::unique_ptr<void, HandleDeleter>;

std::string reason_of(const Handle& handle) { return tjGetErrorStr2(handle.get()); }

tl::unexpected<Error> damaged(std::string_view why) {
  return fail(ErrorKind::bad_data, "damaged or truncated JPEG: {}", why);
}

/// Of the warnings, each of which tells of missing or wrong pixels, this one alone tells of none:
/// behind the last pixel some cameras write a few bytes more.
bool is_harmless(std::string_view warning) {
  return warning.find("extraneous bytes before marker 0xd9") != std::string_view::npos;
}

struct Header {
  ImageSize size;
  bool cmyk = false;
};

Expected<Header> read_header(const Handle& handle, std::string_view bytes) {
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colours = 0;
  // It fails for colours sampled in a way that it has no name for, too, which grey does not need.
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the library's bytes are unsigned
  const auto* const data = reinterpret_cast<const unsigned char*>(bytes.data());
  const int status = tjDecompressHeader3(handle.get(), data, bytes.size(), &width, &height,
                                         &subsampling, &colours);
  if (status != 0 && (width < 1 || height < 1)) return damaged(reason_of(handle));
  return Header{{width, height}, colours == TJCS_CMYK || colours == TJCS_YCCK};
}

/// Header first: what is refused is refused before a pixel is decoded. `place` gives the memory for
/// an image of that size.
template <typename Place>
Status decode(std::string_view bytes, std::optional<ImageSize> expected, int most_scans,
              const Place& place, JpegSegments& segments) {
  const Handle handle(tjInitDecompress());
  WAYMARK_CHECK(handle != nullptr);
  const auto header = read_header(handle, bytes);
  if (!header) return tl::make_unexpected(header.error());
  if (header->cmyk) return fail(ErrorKind::bad_data, "CMYK JPEG; save it as grey or RGB");
  if (auto fits = check_image_size(header->size, expected); !fits) return fits;
  segments = walk_jpeg(bytes, most_scans);
  if (most_scans == 1 && (segments.progressive || segments.scans > 1)) {
    return fail(ErrorKind::bad_data, "a JPEG of several scans, which may take any time");
  }
  if (segments.scans > most_scans) {
    return fail(ErrorKind::bad_data,
                "a JPEG of more than {} scans, which may take any time; save it anew", most_scans);
  }
  const std::string_view tidy = segments.tidied.empty() ? bytes : segments.tidied;
  const auto width = static_cast<int>(header->size.width_px);
  const auto height = static_cast<int>(header->size.height_px);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the library's bytes are unsigned
  const auto* const data = reinterpret_cast<const unsigned char*>(tidy.data());
  if (tjDecompress2(handle.get(), data, tidy.size(), place(width, height), width, width, height,
                    TJPF_GRAY, kFlags) == 0) {
    return {};
  }
  const std::string reason = reason_of(handle);
  if (tjGetErrorCode(handle.get()) == TJERR_WARNING && is_harmless(reason)) return {};
  return damaged(reason);
}

}  // namespace

bool looks_like_jpeg(std::string_view bytes) { return bytes.starts_with("\xFF\xD8\xFF"); }

Expected<ImageSize> jpeg_size(std::string_view bytes) {
  const auto header = read_header(Handle(tjInitDecompress()), bytes);
  if (!header) return tl::make_unexpected(header.error());
  return header->size;
}

Expected<LoadedImage> decode_jpeg(std::string_view bytes, std::optional<ImageSize> expected) {
  LoadedImage loaded;
  JpegSegments segments;
  const auto place = [&](int width, int height) {
    loaded.image = GrayImage(width, height);
    return loaded.image.pixels.data();
  };
  const auto decoded = decode(bytes, expected, kMostScans, place, segments);
  if (!decoded) return tl::make_unexpected(decoded.error());
  loaded.orientation_ignored = segments.orientation != 1;
  return loaded;
}

Status decode_jpeg_into(std::string_view bytes, GrayImage& image) {
  JpegSegments segments;
  const auto place = [&](int, int) { return image.pixels.data(); };
  return decode(bytes, ImageSize{image.width_px, image.height_px}, 1, place, segments);
}

Expected<std::string> encode_jpeg(const GrayView& image, int quality) {
  WAYMARK_CHECK(quality >= 1 && quality <= 100);
  const Handle handle(tjInitCompress());
  WAYMARK_CHECK(handle != nullptr);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;  // NOLINT: the library's type
  const int status =
      tjCompress2(handle.get(), image.data, image.width_px, static_cast<int>(image.stride_bytes),
                  image.height_px, TJPF_GRAY, &buffer, &size, TJSAMP_GRAY, quality, kFlags);
  const std::unique_ptr<unsigned char, decltype(&tjFree)> owned(buffer, &tjFree);
  if (status != 0) {
    return fail(ErrorKind::bad_data, "can't encode {}×{} px as JPEG: {}", image.width_px,
                image.height_px, reason_of(handle));
  }
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes of the file
  return std::string(reinterpret_cast<const char*>(buffer), size);
}

}  // namespace waymark
