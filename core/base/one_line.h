#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace waymark {

/// What a line for people may take.
inline constexpr std::size_t kMaxLineBytes = 500;

/// The text as one printable line of at most `max_bytes`: what a file, a device or a folder says of
/// itself may neither break a message's line, nor reach a terminal as commands, nor flood it.
/// Control characters, invisible ones that turn the writing about, and bytes that are no UTF-8 are
/// spelt out ("\n", "\x1b", "\u202e"); a longer text keeps its beginning and its end, and between
/// them stands how long it was: "unknown key "aaa… (131,500 bytes) …". What is such a line already
/// comes back unchanged.
[[nodiscard]] std::string in_one_line(std::string_view text, std::size_t max_bytes = kMaxLineBytes);

}  // namespace waymark
