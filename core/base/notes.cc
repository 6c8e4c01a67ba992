#include "core/base/notes.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/one_line.h"

namespace waymark {

std::vector<std::string> shown_notes(const std::vector<std::string>& notes) {
  constexpr std::size_t kMost = 20;
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < std::min(notes.size(), kMost); ++i) {
    lines.push_back(in_one_line(notes[i]));
  }
  if (notes.size() > kMost) {
    lines.push_back(fmt::format("… and {} more like these", notes.size() - kMost));
  }
  return lines;
}

std::string caused_note(Cause cause, const std::string& text) {
  return fmt::format("[{}] {}", name_of(cause), text);
}

std::string note_line(const std::string& shown) {
  const auto end = shown.find(']');
  const bool caused = shown.starts_with('[') && end != std::string::npos &&
                      cause_from_name(std::string_view(shown).substr(1, end - 1)).has_value();
  return fmt::format("note{} {}", caused ? "" : ":", shown);
}

}  // namespace waymark
