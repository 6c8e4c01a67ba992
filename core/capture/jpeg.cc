#include "core/capture/jpeg.h"

#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

// In this order: jpeglib.h needs <cstdio> before it, jerror.h needs jpeglib.h.
// clang-format off
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

#include "core/base/check.h"
#include "core/capture/exif.h"

namespace waymark {
namespace {

constexpr int kExifMarker = JPEG_APP0 + 1;
constexpr std::string_view kExifPrefix("Exif\0\0", 6);

/// libjpeg's way to report: it calls error_exit, which must not return. The first message is kept.
struct ErrorManager {
  jpeg_error_mgr base;  ///< first, so that libjpeg's pointer to it is one to this
  std::jmp_buf jump;
  std::array<char, JMSG_LENGTH_MAX> message;
  bool damaged;

  static ErrorManager& of(j_common_ptr info) {
    return *reinterpret_cast<ErrorManager*>(info->err);  // NOLINT
  }

  void keep_message(j_common_ptr info) {
    if (!damaged) base.format_message(info, message.data());
    damaged = true;
  }

  void install() {
    jpeg_std_error(&base);
    damaged = false;
    message.fill('\0');
    base.error_exit = [](j_common_ptr info) {
      of(info).keep_message(info);
      std::longjmp(of(info).jump, 1);  // NOLINT: no destructor stands between here and setjmp
    };
    base.emit_message = [](j_common_ptr info, int level) {
      // Below 0: pixels are wrong or missing, except in the case of the codes named here.
      const int code = info->err->msg_code;
      const bool harmless =
          code == JWRN_EXTRANEOUS_DATA || code == JWRN_ADOBE_XFORM || code == JWRN_JFIF_MAJOR;
      if (level < 0 && !harmless) of(info).keep_message(info);
    };
    base.output_message = [](j_common_ptr) {};
  }
};

/// Functions that call setjmp hold only plain members of this, so that longjmp skips no destructor.
class Decoder {
 public:
  Decoder() {
    errors_.install();
    info_.err = &errors_.base;
    jpeg_create_decompress(&info_);
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  ~Decoder() { jpeg_destroy_decompress(&info_); }

  /// Reads all but the pixels.
  Status open(std::string_view bytes) {
    if (!read_header(bytes)) return damaged();
    if (info_.jpeg_color_space == JCS_CMYK || info_.jpeg_color_space == JCS_YCCK) {
      return fail(ErrorKind::bad_data, "CMYK JPEG; save it as grey or RGB");
    }
    if (std::size_t{info_.image_width} * info_.image_height > kMaxImagePixels) {
      return fail(ErrorKind::bad_data, "{}×{} px; more than 200 megapixels", info_.image_width,
                  info_.image_height);
    }
    return {};
  }
  [[nodiscard]] int width_px() const { return static_cast<int>(info_.image_width); }
  [[nodiscard]] int height_px() const { return static_cast<int>(info_.image_height); }

  [[nodiscard]] bool has_several_scans() { return jpeg_has_multiple_scans(&info_) != FALSE; }

  /// Of an opened JPEG, whose size the image has.
  Status read_into(GrayImage& image) {
    if (!read_pixels(image) || errors_.damaged) return damaged();
    return {};
  }

  /// As Exif says; 1 is upright.
  [[nodiscard]] int orientation() const {
    for (auto marker = info_.marker_list; marker != nullptr; marker = marker->next) {
      const std::span<const std::uint8_t> data(marker->data, marker->data_length);
      // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): text within bytes
      const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
      if (marker->marker == kExifMarker && text.starts_with(kExifPrefix)) {
        return exif_orientation(data.subspan(kExifPrefix.size()));
      }
    }
    return 1;
  }

 private:
  [[nodiscard]] tl::unexpected<Error> damaged() const {
    return fail(ErrorKind::bad_data, "damaged or truncated JPEG: {}", errors_.message.data());
  }

  bool read_header(std::string_view bytes) {
    if (setjmp(errors_.jump) != 0) return false;  // NOLINT
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): libjpeg takes bytes as unsigned
    jpeg_mem_src(&info_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_save_markers(&info_, kExifMarker, 0xFFFF);
    jpeg_read_header(&info_, TRUE);
    return true;
  }

  bool read_pixels(GrayImage& image) {
    if (setjmp(errors_.jump) != 0) return false;  // NOLINT
    info_.out_color_space = JCS_GRAYSCALE;
    jpeg_start_decompress(&info_);
    while (info_.output_scanline < info_.output_height) {
      JSAMPROW row = image.row(static_cast<int>(info_.output_scanline));
      jpeg_read_scanlines(&info_, &row, 1);
    }
    jpeg_finish_decompress(&info_);
    return true;
  }

  ErrorManager errors_{};
  jpeg_decompress_struct info_{};
};

class Encoder {
 public:
  Encoder() {
    errors_.install();
    info_.err = &errors_.base;
    jpeg_create_compress(&info_);
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  ~Encoder() {
    jpeg_destroy_compress(&info_);
    std::free(buffer_);  // NOLINT: jpeg_mem_dest allocates it by malloc
  }

  Expected<std::string> encode(const GrayView& image, int quality) {
    if (!compress(image, quality)) {
      return fail(ErrorKind::bad_data, "can't encode {}×{} px as JPEG: {}", image.width_px,
                  image.height_px, errors_.message.data());
    }
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes of the file
    return std::string(reinterpret_cast<const char*>(buffer_), size_);
  }

 private:
  bool compress(const GrayView& image, int quality) {
    if (setjmp(errors_.jump) != 0) return false;  // NOLINT
    jpeg_mem_dest(&info_, &buffer_, &size_);
    info_.image_width = static_cast<JDIMENSION>(image.width_px);
    info_.image_height = static_cast<JDIMENSION>(image.height_px);
    info_.input_components = 1;
    info_.in_color_space = JCS_GRAYSCALE;
    jpeg_set_defaults(&info_);
    jpeg_set_quality(&info_, quality, TRUE);
    jpeg_start_compress(&info_, TRUE);
    while (info_.next_scanline < info_.image_height) {
      // libjpeg only reads it.
      JSAMPROW row =
          const_cast<JSAMPROW>(image.row(static_cast<int>(info_.next_scanline)));  // NOLINT
      jpeg_write_scanlines(&info_, &row, 1);
    }
    jpeg_finish_compress(&info_);
    return true;
  }

  ErrorManager errors_{};
  jpeg_compress_struct info_{};
  unsigned char* buffer_ = nullptr;
  unsigned long size_ = 0;  // NOLINT: libjpeg's type
};

}  // namespace

bool looks_like_jpeg(std::string_view bytes) { return bytes.starts_with("\xFF\xD8\xFF"); }

Expected<LoadedImage> decode_jpeg(std::string_view bytes) {
  // On the heap: the structs are large, and longjmp leaves members of an object alone.
  const auto decoder = std::make_unique<Decoder>();
  if (auto opened = decoder->open(bytes); !opened) return tl::make_unexpected(opened.error());
  LoadedImage loaded;
  loaded.orientation_ignored = decoder->orientation() != 1;
  loaded.image = GrayImage(decoder->width_px(), decoder->height_px());
  if (auto read = decoder->read_into(loaded.image); !read) return tl::make_unexpected(read.error());
  return loaded;
}

Status decode_jpeg_into(std::string_view bytes, GrayImage& image) {
  const auto decoder = std::make_unique<Decoder>();
  if (auto opened = decoder->open(bytes); !opened) return opened;
  if (decoder->width_px() != image.width_px || decoder->height_px() != image.height_px) {
    return fail(ErrorKind::bad_data, "a JPEG of {}×{} px among {}×{}", decoder->width_px(),
                decoder->height_px(), image.width_px, image.height_px);
  }
  if (decoder->has_several_scans()) {
    return fail(ErrorKind::bad_data, "a JPEG of several scans, which may take any time");
  }
  return decoder->read_into(image);
}

Expected<std::string> encode_jpeg(const GrayView& image, int quality) {
  WAYMARK_CHECK(quality >= 1 && quality <= 100);
  return std::make_unique<Encoder>()->encode(image, quality);
}

}  // namespace waymark
