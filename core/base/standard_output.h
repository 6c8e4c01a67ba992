#pragma once

#include <string_view>

namespace waymark {

/// With what a program ends that would end with `code`: io (74) and a line on standard error where
/// all went well, but what was printed to standard output (by streams of C or C++) did not arrive:
/// a full disk, a closed descriptor. `program` begins the line.
[[nodiscard]] int exit_code_after_output(int code, std::string_view program);

}  // namespace waymark
