#include "core/capture/jpeg.h"

#include <turbojpeg.h>

#include <memory>

#include "tests/fuzz/format.h"
#include "tests/fuzz/image_format.h"
#include "tests/support/exif_block.h"
#include "tests/support/test_pattern.h"

namespace waymark::test {
namespace {

/// In colour, its chroma halved both ways, in several scans.
std::string progressive_jpeg() {
  const std::vector<unsigned char> pixels(
      std::size_t{3} * kImageSize.width_px * kImageSize.height_px, 90);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const tjhandle compressor = tjInitCompress();
  WAYMARK_CHECK(tjCompress2(compressor, pixels.data(), static_cast<int>(kImageSize.width_px), 0,
                            static_cast<int>(kImageSize.height_px), TJPF_RGB, &bytes, &size,
                            TJSAMP_420, 80, TJFLAG_PROGRESSIVE) == 0);
  std::string jpeg(bytes, bytes + size);
  tjFree(bytes);
  tjDestroy(compressor);
  return jpeg;
}

/// With a rotation in its EXIF block, as telephones write it.
std::string rotated(const std::string& jpeg) {
  const std::vector<std::uint8_t> block = exif_block(6, true);
  const std::string content = std::string("Exif\0\0", 6) + std::string(block.begin(), block.end());
  const std::size_t length = content.size() + 2;
  return jpeg.substr(0, 2) +
         std::string{'\xFF', '\xE1', static_cast<char>(length >> 8U), static_cast<char>(length)} +
         content + jpeg.substr(2);
}

/// As a file, and as a camera's frame.
Expected<LoadedImage> read(const std::string& bytes) {
  static GrayImage frame(static_cast<int>(kImageSize.width_px),
                         static_cast<int>(kImageSize.height_px));
  (void)decode_jpeg_into(bytes, frame);
  return read_image(bytes, jpeg_size, decode_jpeg);
}

std::vector<std::string> seeds() {
  const GrayImage pattern = image_seed();
  const std::string plain = encode_jpeg(pattern.view(), 90).value();
  return {plain, encode_jpeg(pattern.view(), 20).value(), progressive_jpeg(), rotated(plain)};
}

const AddFormat jpeg({"Jpeg",
                      seeds(),
                      {"\xFF\xD8", "\xFF\xC0", "\xFF\xC2", "\xFF\xC4", "\xFF\xDA", "\xFF\xDB",
                       "\xFF\xDD", "\xFF\xE0", "\xFF\xE1", "\xFF\xEE", "\xFF\xD9", "Exif", "JFIF",
                       "Adobe", "II*", "MM"},
                      reader(read)});

}  // namespace
}  // namespace waymark::test
