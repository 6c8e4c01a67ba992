#pragma once

#include <string>
#include <string_view>

#include "core/base/one_line.h"

namespace waymark {

/// What a program prints of a command line that it does not understand: the parser's reason, which
/// quotes the arguments, as one printable line, and where the options are listed.
[[nodiscard]] inline std::string usage_text(std::string_view reason) {
  return in_one_line(reason) + "\nRun with --help for more information.\n";
}

}  // namespace waymark
