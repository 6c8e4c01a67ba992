#pragma once

#include <string>
#include <vector>

namespace waymark {

/// The lines in which notes about one input are shown: each printable, the first 20 of them, and
/// then how many more there are.
[[nodiscard]] std::vector<std::string> shown_notes(const std::vector<std::string>& notes);

}  // namespace waymark
