#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace waymark {

/// Numbers, texts and bytes in turn from the front of what a file holds, never from beyond its end:
/// what is not there is 0 or empty, and `failed` says so ever after. The bytes must outlive it.
class ByteCursor {
 public:
  ByteCursor(std::span<const std::uint8_t> bytes, std::endian order)
      : bytes_(bytes), order_(order) {}

  /// An integer or IEEE number in the cursor's byte order.
  template <typename Number>
  Number number() {
    std::uint8_t raw[sizeof(Number)] = {};
    const auto source = this->bytes(sizeof(Number));
    for (std::size_t i = 0; i < source.size(); ++i) {
      raw[order_ == std::endian::native ? i : sizeof(Number) - 1 - i] = source[i];
    }
    Number value{};
    std::memcpy(&value, raw, sizeof value);
    return value;
  }

  /// The next `count` bytes; none when fewer are left.
  std::span<const std::uint8_t> bytes(std::size_t count) {
    failed_ = failed_ || count > left();
    if (failed_) return {};
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }

  std::string_view text(std::size_t count) {
    const auto taken = bytes(count);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes of a text
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }

  /// Passes over what lies before the next multiple of `size`, counted from the front.
  void align(std::size_t size) { (void)bytes((size - at_ % size) % size); }

  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::endian order_;
  std::size_t at_ = 0;
  bool failed_ = false;
};

}  // namespace waymark
