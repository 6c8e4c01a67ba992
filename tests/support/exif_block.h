#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace waymark {

/// A TIFF header with one directory of two entries: the image's width and its orientation.
inline std::vector<std::uint8_t> exif_block(int orientation, bool little_endian) {
  std::vector<std::uint8_t> block;
  const auto put = [&](unsigned value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t byte = little_endian ? i : size - 1 - i;
      block.push_back(static_cast<std::uint8_t>(value >> (8 * byte)));
    }
  };
  const std::uint8_t mark = little_endian ? 'I' : 'M';
  block = {mark, mark};
  put(42, 2);
  put(8, 4);       // offset of the directory
  put(2, 2);       // entries
  put(0x0100, 2);  // ImageWidth, one LONG
  put(4, 2);
  put(1, 4);
  put(64, 4);
  put(0x0112, 2);  // Orientation, one SHORT
  put(3, 2);
  put(1, 4);
  put(static_cast<unsigned>(orientation), 2);
  put(0, 2);
  put(0, 4);  // no further directory
  return block;
}

}  // namespace waymark
