#include "core/capture/foreign_format.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/base/text_field.h"

namespace waymark {
namespace {

struct Ending {
  std::string_view ending;
  std::string_view format;
};

constexpr std::array kEndings{
    Ending{".bmp", "BMP"},        Ending{".dib", "BMP"},        Ending{".tif", "TIFF"},
    Ending{".tiff", "TIFF"},      Ending{".webp", "WebP"},      Ending{".gif", "GIF"},
    Ending{".heic", "HEIF"},      Ending{".heif", "HEIF"},      Ending{".avif", "AVIF"},
    Ending{".ppm", "PPM"},        Ending{".jp2", "JPEG 2000"},  Ending{".jxl", "JPEG XL"},
    Ending{".exr", "EXR"},        Ending{".dng", "camera raw"}, Ending{".nef", "camera raw"},
    Ending{".cr2", "camera raw"}, Ending{".arw", "camera raw"}, Ending{".raw", "camera raw"},
};

struct Magic {
  std::size_t at;
  std::string_view bytes;
  std::string_view format;
};

constexpr std::array kMagics{
    Magic{0, "BM", "BMP"},
    Magic{0, {"II*\0", 4}, "TIFF"},
    Magic{0, {"MM\0*", 4}, "TIFF"},
    Magic{0, {"II+\0", 4}, "TIFF"},
    Magic{0, {"MM\0+", 4}, "TIFF"},
    Magic{8, "WEBP", "WebP"},
    Magic{0, "GIF8", "GIF"},
    Magic{4, "ftypheic", "HEIF"},
    Magic{4, "ftypmif1", "HEIF"},
    Magic{4, "ftypavif", "AVIF"},
    Magic{4, {"jP  \r\n\x87\n", 8}, "JPEG 2000"},
    Magic{0, {"\xFF\x0A", 2}, "JPEG XL"},
    Magic{0, {"v/1\x01", 4}, "EXR"},
};

}  // namespace

std::string_view foreign_format_of_name(const std::filesystem::path& path) {
  const std::string ending = lower_case(path.extension().string());
  const auto* const found =
      std::find_if(kEndings.begin(), kEndings.end(),
                   [&](const Ending& known) { return known.ending == ending; });
  return found == kEndings.end() ? std::string_view() : found->format;
}

std::string_view foreign_format_of_content(std::string_view bytes) {
  const auto* const found = std::find_if(kMagics.begin(), kMagics.end(), [&](const Magic& magic) {
    return bytes.size() > magic.at && bytes.substr(magic.at).starts_with(magic.bytes);
  });
  return found == kMagics.end() ? std::string_view() : found->format;
}

}  // namespace waymark
