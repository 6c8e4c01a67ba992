#include "core/capture/png.h"

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "core/capture/exif.h"

namespace waymark {
namespace {

constexpr int kFastestCompression = 1;

/// libpng's way to report: it calls the error function, which must not return.
struct Failure {
  std::jmp_buf jump;
  std::array<char, 128> message{};

  static void on_error(png_structp png, png_const_charp text) {
    auto& self = *static_cast<Failure*>(png_get_error_ptr(png));
    std::strncpy(self.message.data(), text, self.message.size() - 1);
    std::longjmp(self.jump, 1);  // NOLINT: no destructor stands between here and setjmp
  }
  static void on_warning(png_structp, png_const_charp) {}
};

/// Functions that call setjmp hold only plain members of this, so that longjmp skips no destructor.
class Decoder {
 public:
  explicit Decoder(std::string_view bytes) : rest_(bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure_, Failure::on_error,
                                  Failure::on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  ~Decoder() { png_destroy_read_struct(&png_, &info_, nullptr); }

  Expected<LoadedImage> decode() {
    if (info_ == nullptr || !read_header()) return damaged();
    const std::size_t width = png_get_image_width(png_, info_);
    const std::size_t height = png_get_image_height(png_, info_);
    if (width * height > kMaxImagePixels) {
      return fail(ErrorKind::bad_data, "{}×{} px; more than 200 megapixels", width, height);
    }
    LoadedImage loaded;
    loaded.reduced_from_16_bit = png_get_bit_depth(png_, info_) == 16;
    if (!choose_transforms()) return damaged();
    channels_ = png_get_channels(png_, info_);
    samples_.resize(width * height * channels_);
    for (std::size_t y = 0; y < height; ++y) rows_.push_back(&samples_[y * width * channels_]);
    if (!read_pixels()) return damaged();
    loaded.orientation_ignored = orientation() != 1;
    loaded.image = GrayImage(static_cast<int>(width), static_cast<int>(height));
    convert_to_gray(loaded.image);
    return loaded;
  }

 private:
  [[nodiscard]] tl::unexpected<Error> damaged() const {
    return fail(ErrorKind::bad_data, "damaged or truncated PNG: {}", failure_.message.data());
  }

  static void take_bytes(png_structp png, png_bytep out, std::size_t count) {
    auto& rest = static_cast<Decoder*>(png_get_io_ptr(png))->rest_;
    if (count > rest.size()) png_error(png, "the file ends too early");
    std::memcpy(out, rest.data(), count);
    rest.remove_prefix(count);
  }

  bool read_header() {
    if (setjmp(failure_.jump) != 0) return false;  // NOLINT
    png_set_read_fn(png_, this, take_bytes);
    png_read_info(png_, info_);
    return true;
  }

  bool choose_transforms() {
    if (setjmp(failure_.jump) != 0) return false;  // NOLINT
    png_set_strip_16(png_);
    png_set_expand(png_);  // palette to RGB, 1 2 4 bits to 8, transparency to alpha
    png_set_strip_alpha(png_);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return true;
  }

  bool read_pixels() {
    if (setjmp(failure_.jump) != 0) return false;  // NOLINT
    png_read_image(png_, rows_.data());
    png_read_end(png_, info_);
    return true;
  }

  [[nodiscard]] int orientation() const {
    png_uint_32 count = 0;
    png_bytep data = nullptr;
    if (png_get_eXIf_1(png_, info_, &count, &data) == 0 || data == nullptr) return 1;
    return exif_orientation({data, count});
  }

  void convert_to_gray(GrayImage& image) const {
    if (channels_ == 1) {
      image.pixels = samples_;
      return;
    }
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      const std::uint8_t* const rgb = &samples_[i * channels_];
      // Rec. 601, weights in thousandths, rounded.
      image.pixels[i] =
          static_cast<std::uint8_t>((299U * rgb[0] + 587U * rgb[1] + 114U * rgb[2] + 500U) / 1000U);
    }
  }

  std::string_view rest_;
  Failure failure_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::size_t channels_ = 0;
  std::vector<std::uint8_t> samples_;
  std::vector<png_bytep> rows_;
};

class Encoder {
 public:
  Encoder() {
    png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, &failure_, Failure::on_error,
                                   Failure::on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  ~Encoder() { png_destroy_write_struct(&png_, &info_); }

  Expected<std::string> encode(const GrayView& image) {
    if (info_ == nullptr || !write(image)) {
      return fail(ErrorKind::bad_data, "can't encode {}×{} px as PNG: {}", image.width_px,
                  image.height_px, failure_.message.data());
    }
    return std::move(bytes_);
  }

 private:
  static void append(png_structp png, png_bytep data, std::size_t count) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes of the file
    static_cast<Encoder*>(png_get_io_ptr(png))->bytes_.append(reinterpret_cast<char*>(data), count);
  }

  bool write(const GrayView& image) {
    if (setjmp(failure_.jump) != 0) return false;  // NOLINT
    png_set_write_fn(png_, this, append, nullptr);
    png_set_compression_level(png_, kFastestCompression);
    png_set_IHDR(png_, info_, static_cast<png_uint_32>(image.width_px),
                 static_cast<png_uint_32>(image.height_px), 8, PNG_COLOR_TYPE_GRAY,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png_, info_);
    for (int y = 0; y < image.height_px; ++y) png_write_row(png_, image.row(y));
    png_write_end(png_, info_);
    return true;
  }

  Failure failure_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::string bytes_;
};

}  // namespace

bool looks_like_png(std::string_view bytes) { return bytes.starts_with("\x89PNG\r\n\x1A\n"); }

Expected<LoadedImage> decode_png(std::string_view bytes) { return Decoder(bytes).decode(); }

Expected<std::string> encode_png(const GrayView& image) { return Encoder().encode(image); }

}  // namespace waymark
