#pragma once

#include <fmt/format.h>

#include <ostream>
#include <utility>

#include "core/base/one_line.h"

namespace waymark {

/// Prints a line that names files: printable and at most kMaxLineBytes, whatever they are called.
template <typename... Args>
void print_line(std::ostream& out, fmt::format_string<Args...> text, Args&&... args) {
  out << in_one_line(fmt::format(text, std::forward<Args>(args)...)) << '\n';
}

}  // namespace waymark
