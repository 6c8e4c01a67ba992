#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace waymark {

/// The text with control characters spelt out ("\n", "\x1b"): what a file says of itself may
/// neither break a message's line nor reach a terminal as commands.
[[nodiscard]] inline std::string in_one_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '\n') {
      line += "\\n";
    } else if (code < 0x20 || code == 0x7f) {
      line += fmt::format("\\x{:02x}", code);
    } else {
      line += c;
    }
  }
  return line;
}

}  // namespace waymark
