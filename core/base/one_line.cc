#include "core/base/one_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace waymark {
namespace {

/// The character that a text of UTF-8 begins with; length 0 when its first byte begins none.
struct Character {
  char32_t code = 0;
  std::size_t length = 0;
};

bool continues(char byte) { return (static_cast<unsigned char>(byte) & 0xc0U) == 0x80U; }

Character first_character(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return {lead, 1};
  const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < length) return {};
  char32_t code = lead & (0x7fU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if (!continues(text[i])) return {};
    code = code << 6U | (static_cast<unsigned char>(text[i]) & 0x3fU);
  }
  constexpr char32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  if (code < kSmallest[length] || code > 0x10ffff || surrogate) return {};
  return {code, length};
}

bool is_printable(char32_t code) {
  const auto within = [code](char32_t first, char32_t last) {
    return code >= first && code <= last;
  };
  const bool control = code < 0x20 || within(0x7f, 0x9f);
  const bool invisible =
      within(0x200b, 0x200f) || within(0x2028, 0x202e) || within(0x2060, 0x206f) || code == 0xfeff;
  return !control && !invisible;
}

std::string spelt_out(std::string_view text) {
  std::string line;
  while (!text.empty()) {
    const auto [code, length] = first_character(text);
    if (length > 0 && is_printable(code)) {
      line += text.substr(0, length);
    } else if (code == '\n') {
      line += "\\n";
    } else if (length > 1) {
      line += fmt::format("\\u{:04x}", static_cast<std::uint32_t>(code));
    } else {
      line += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return line;
}

std::string with_thousands(std::size_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, ",");
  return digits;
}

}  // namespace

std::string in_one_line(std::string_view text, std::size_t max_bytes) {
  std::string line = spelt_out(text);
  if (line.size() <= max_bytes) return line;
  const std::string mark = fmt::format("… ({} bytes) …", with_thousands(text.size()));
  // What is wrong stands at the beginning, what to do about it at the end.
  const std::size_t tail = max_bytes / 4;
  std::size_t head_end = max_bytes - mark.size() - tail;
  std::size_t tail_begin = line.size() - tail;
  while (continues(line[head_end])) --head_end;
  while (continues(line[tail_begin])) ++tail_begin;
  return line.substr(0, head_end) + mark + line.substr(tail_begin);
}

}  // namespace waymark
