#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "mapbuilder/import/byte_cursor.h"

namespace waymark {

/// Reads a message as ROS 2 serializes it: XCDR1 with its header of 4 bytes, of either byte order.
/// Numbers lie at multiples of their size, counted from behind the header. Nothing is read from
/// beyond the end: what is not there is 0 or empty, and `failed` says so.
class CdrReader {
 public:
  /// nullopt for bytes of another encoding.
  [[nodiscard]] static std::optional<CdrReader> open(std::span<const std::uint8_t> message) {
    constexpr std::size_t kHeader = 4;
    if (message.size() < kHeader || message[0] != 0 || message[1] > 1) return std::nullopt;
    return CdrReader(
        {message.subspan(kHeader), message[1] == 1 ? std::endian::little : std::endian::big});
  }

  template <typename Number>
  Number number() {
    cursor_.align(sizeof(Number));
    return cursor_.number<Number>();
  }

  /// Its length counts a 0 at the end.
  std::string text() {
    const auto size = number<std::uint32_t>();
    const std::string_view whole = cursor_.text(size);
    return std::string(whole.substr(0, whole.find('\0')));
  }

  /// A sequence of bytes.
  std::span<const std::uint8_t> bytes() {
    const auto size = number<std::uint32_t>();
    return cursor_.bytes(size);
  }

  [[nodiscard]] std::size_t left() const { return cursor_.left(); }
  [[nodiscard]] bool failed() const { return cursor_.failed(); }

 private:
  explicit CdrReader(ByteCursor cursor) : cursor_(cursor) {}

  ByteCursor cursor_;
};

}  // namespace waymark
