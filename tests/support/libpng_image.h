#pragma once

#include <png.h>

#include <random>
#include <string>
#include <vector>

namespace waymark {

inline constexpr int kPngWidth =
    19;  ///< of libpng's images; no multiple of an interlaced pass's steps
inline constexpr int kPngHeight = 13;

/// Random samples of one kind, written by libpng.
inline std::string libpng_png(int kind, int depth, int interlace) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  std::string bytes;
  png_set_write_fn(
      png, &bytes,
      [](png_structp from, png_bytep data, std::size_t size) {
        static_cast<std::string*>(png_get_io_ptr(from))
            ->append(reinterpret_cast<const char*>(data), size);
      },
      nullptr);
  png_set_IHDR(png, info, kPngWidth, kPngHeight, depth, kind, interlace,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  std::mt19937 random(5);
  if (kind == PNG_COLOR_TYPE_PALETTE) {
    std::vector<png_color> palette(std::size_t{1} << depth);
    for (png_color& color : palette) {
      color = {static_cast<png_byte>(random()), static_cast<png_byte>(random()),
               static_cast<png_byte>(random())};
    }
    png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  }
  png_write_info(png, info);
  std::vector<std::vector<png_byte>> rows(kPngHeight,
                                          std::vector<png_byte>(png_get_rowbytes(png, info)));
  std::vector<png_bytep> pointers;
  for (auto& row : rows) {
    for (png_byte& byte : row) byte = static_cast<png_byte>(random());
    pointers.push_back(row.data());
  }
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

}  // namespace waymark
