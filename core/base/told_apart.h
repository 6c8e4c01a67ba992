#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

namespace waymark {

/// Two different numbers as texts that differ, too: with two digits where these tell them apart,
/// with as many more as it takes. "Known to ± 0.1, 0.1 is asked for" says nothing.
[[nodiscard]] inline std::pair<std::string, std::string> told_apart(double a, double b) {
  constexpr int kFewest = 2;
  constexpr int kMost = 17;
  std::pair<std::string, std::string> texts;
  for (int digits = kFewest; digits <= kMost; ++digits) {
    texts = {fmt::format("{:.{}g}", a, digits), fmt::format("{:.{}g}", b, digits)};
    if (texts.first != texts.second || a == b) break;
  }
  return texts;
}

}  // namespace waymark
