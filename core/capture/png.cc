#include "core/capture/png.h"

#include <spng.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "core/base/check.h"
#include "core/capture/exif.h"
#include "core/capture/pixel_depth.h"

namespace waymark {
namespace {

constexpr int kFastestCompression = 1;
/// Of texts, profiles and EXIF blocks each and together, unpacked. The library asks for as much
/// again as it has, so that one of more than half of this is refused.
constexpr std::size_t kLargestChunk = std::size_t{8} << 20;
constexpr std::size_t kAllChunks = std::size_t{16} << 20;

constexpr std::string_view kEndChunk("\0\0\0\0IEND\xAE\x42\x60\x82", 12);

struct ContextDeleter {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using Context = std::unique_ptr<spng_ctx, ContextDeleter>;

tl::unexpected<Error> damaged(int status) {
  return fail(ErrorKind::bad_data, "damaged or truncated PNG: {}", spng_strerror(status));
}

/// Columns of a row that one pass of an interlaced image brings; all in one pass otherwise.
struct Columns {
  std::size_t first;
  std::size_t step;
};

Columns columns_of(const spng_row_info& row, bool interlaced) {
  constexpr std::array<Columns, 7> kAdam7{{{0, 8}, {4, 8}, {0, 4}, {2, 4}, {0, 2}, {1, 2}, {0, 1}}};
  return interlaced ? kAdam7.at(static_cast<std::size_t>(row.pass)) : Columns{0, 1};
}

/// Rec. 601, weights in thousandths, rounded; of one or two channels (grey, and alpha) the first.
template <typename Sample>
std::uint8_t luma(const Sample* pixel, std::size_t channels, int shift) {
  const auto upper = [&](std::size_t c) { return static_cast<unsigned>(pixel[c]) >> shift; };
  if (channels < 3) return static_cast<std::uint8_t>(upper(0));
  return static_cast<std::uint8_t>((299U * upper(0) + 587U * upper(1) + 114U * upper(2) + 500U) /
                                   1000U);
}

/// Decodes row by row, once.
class Decoder {
 public:
  explicit Decoder(std::string_view bytes)
      : context_(spng_ctx_new(0)), ends_whole_(bytes.rfind(kEndChunk) != std::string_view::npos) {
    WAYMARK_CHECK(context_ != nullptr);
    spng_set_png_buffer(context_.get(), bytes.data(), bytes.size());
    spng_set_chunk_limits(context_.get(), kLargestChunk, kAllChunks);
    status_ = spng_get_ihdr(context_.get(), &header_);
  }

  [[nodiscard]] int status() const { return status_; }
  [[nodiscard]] ImageSize size() const { return {header_.width, header_.height}; }
  [[nodiscard]] bool is_deep() const { return header_.bit_depth == 16; }

  /// The largest value of all colours.
  int read_largest(int& largest) {
    return read_rows<std::uint16_t>(
        [&](const std::uint16_t* row, std::size_t channels, int, const Columns& columns) {
          const std::size_t colours = channels < 3 ? 1 : 3;
          for (std::size_t x = columns.first; x < header_.width; x += columns.step) {
            for (std::size_t c = 0; c < colours; ++c) {
              largest = std::max<int>(largest, row[x * channels + c]);
            }
          }
        });
  }

  /// The grey values, of which `shift` bits are dropped.
  int read_into(GrayImage& image, int shift) {
    const auto take = [&](const auto* row, std::size_t channels, int y, const Columns& columns) {
      std::uint8_t* const gray = image.row(y);
      for (std::size_t x = columns.first; x < header_.width; x += columns.step) {
        gray[x] = luma(&row[x * channels], channels, shift);
      }
    };
    return is_deep() ? read_rows<std::uint16_t>(take) : read_rows<std::uint8_t>(take);
  }

  /// As EXIF says; 1 is upright. Once all is read.
  [[nodiscard]] int orientation() const {
    spng_exif exif{};
    if (spng_get_exif(context_.get(), &exif) != 0) return 1;
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes of a block
    return exif_orientation({reinterpret_cast<const std::uint8_t*>(exif.data), exif.length});
  }

 private:
  /// As stored, but palettes as colours and values below 8 bits as 8.
  [[nodiscard]] int format() const {
    if (header_.color_type == SPNG_COLOR_TYPE_INDEXED) return SPNG_FMT_RGB8;
    if (header_.bit_depth < 8) return SPNG_FMT_G8;
    return SPNG_FMT_PNG;
  }

  /// Calls `take(row, channels, y, columns)` for every row of every pass.
  template <typename Sample, typename Take>
  int read_rows(const Take& take) {
    int status = spng_decode_image(context_.get(), nullptr, 0, format(), SPNG_DECODE_PROGRESSIVE);
    std::size_t image_bytes = 0;
    if (status == 0) status = spng_decoded_image_size(context_.get(), format(), &image_bytes);
    if (status != 0) return status;
    const std::size_t channels = image_bytes / header_.height / header_.width / sizeof(Sample);
    WAYMARK_CHECK(channels >= 1 && channels <= 4);
    std::vector<Sample> row(header_.width * channels);
    while (status != SPNG_EOI) {
      spng_row_info info{};
      if (const int told = spng_get_row_info(context_.get(), &info); told != 0) return told;
      status = spng_decode_row(context_.get(), row.data(), row.size() * sizeof(Sample));
      if (status != 0 && status != SPNG_EOI) return status;
      take(row.data(), channels, static_cast<int>(info.row_num),
           columns_of(info, header_.interlace_method != 0));
    }
    status = spng_decode_chunks(context_.get());
    return status == 0 && !ends_whole_ ? SPNG_EIO : status;
  }

  Context context_;
  spng_ihdr header_{};
  int status_ = 0;
  bool ends_whole_;  ///< the library does not ask for the end chunk's last bytes
};

/// The library's status; 0: all well.
int encode(const GrayView& image, std::string& bytes) {
  const Context context(spng_ctx_new(SPNG_CTX_ENCODER));
  WAYMARK_CHECK(context != nullptr);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(image.width_px);
  header.height = static_cast<std::uint32_t>(image.height_px);
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_GRAYSCALE;
  if (const int status = spng_set_ihdr(context.get(), &header); status != 0) return status;
  spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, kFastestCompression);
  int status = spng_encode_image(context.get(), nullptr, 0, SPNG_FMT_PNG,
                                 SPNG_ENCODE_PROGRESSIVE | SPNG_ENCODE_FINALIZE);
  for (int y = 0; y < image.height_px && status == 0; ++y) {
    status = spng_encode_row(context.get(), image.row(y), header.width);
  }
  if (status != SPNG_EOI) return status;
  std::size_t size = 0;
  const std::unique_ptr<void, decltype(&std::free)> buffer(
      spng_get_png_buffer(context.get(), &size, &status), &std::free);
  if (buffer == nullptr) return status;
  bytes.assign(static_cast<const char*>(buffer.get()), size);
  return 0;
}

}  // namespace

bool looks_like_png(std::string_view bytes) { return bytes.starts_with("\x89PNG\r\n\x1A\n"); }

Expected<ImageSize> png_size(std::string_view bytes) {
  const Decoder decoder(bytes);
  if (decoder.status() != 0) return damaged(decoder.status());
  return decoder.size();
}

Expected<LoadedImage> decode_png(std::string_view bytes, std::optional<ImageSize> expected) {
  Decoder decoder(bytes);
  if (decoder.status() != 0) return damaged(decoder.status());
  const ImageSize size = decoder.size();
  if (auto fits = check_image_size(size, expected); !fits) {
    return tl::make_unexpected(fits.error());
  }
  LoadedImage loaded;
  if (decoder.is_deep()) {
    int largest = 0;
    if (const int status = Decoder(bytes).read_largest(largest); status != 0) {
      return damaged(status);
    }
    loaded.deep = DeepPixels{largest, bits_in_use(largest)};
  }
  loaded.image = GrayImage(static_cast<int>(size.width_px), static_cast<int>(size.height_px));
  const int shift = loaded.deep ? loaded.deep->bits_in_use - 8 : 0;
  if (const int status = decoder.read_into(loaded.image, shift); status != 0) {
    return damaged(status);
  }
  loaded.orientation_ignored = decoder.orientation() != 1;
  return loaded;
}

Expected<std::string> encode_png(const GrayView& image) {
  std::string bytes;
  if (const int status = encode(image, bytes); status != 0) {
    return fail(ErrorKind::bad_data, "can't encode {}×{} px as PNG: {}", image.width_px,
                image.height_px, spng_strerror(status));
  }
  return bytes;
}

}  // namespace waymark
