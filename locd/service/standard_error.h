#pragma once

#include <climits>
#include <cstddef>
#include <string>

namespace waymark {

/// A line and its end that is offered to stderr: what a pipe takes whole or not at all.
inline constexpr std::size_t kMaxOfferedBytes = PIPE_BUF;

/// Writes a line to stderr, or to another descriptor, without waiting for who reads it: a journal
/// that stands still holds up nobody. Longer ones end at kMaxOfferedBytes; the line's end is added.
/// False: nobody takes it now, and it is lost.
bool offer_line(std::string line, int descriptor = 2);

}  // namespace waymark
