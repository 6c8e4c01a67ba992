#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace waymark {

/// Hash of plain numbers and text, in the order in which they are added: alike on every machine.
class Fingerprint {
 public:
  void add(double value) { append(&value, sizeof value); }
  void add(std::int64_t value) { append(&value, sizeof value); }
  /// Its length goes with it.
  void add(std::string_view text) {
    add(static_cast<std::int64_t>(text.size()));
    append(text.data(), text.size());
  }
  void add(std::span<const double> values) { append(values.data(), values.size_bytes()); }
  /// 16 digits.
  [[nodiscard]] std::string hexadecimal() const;

 private:
  void append(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  std::string bytes_;
};

}  // namespace waymark
