#include "core/marker/image_families.h"

#include <fmt/ranges.h>

#include <string_view>

namespace waymark {

std::vector<Family> families_in_images(const MarkerCatalog& catalog) {
  std::vector<Family> families;
  for (const auto& entry : catalog.entries()) {
    if (is_found_in_images(entry.family)) families.push_back(entry.family);
  }
  return families;
}

Expected<std::optional<std::string>> shown_in_images(const MarkerCatalog& catalog,
                                                     const std::string& name) {
  std::vector<std::string_view> others;
  for (const auto& entry : catalog.entries()) {
    if (!is_found_in_images(entry.family)) others.push_back(name_of(entry.family));
  }
  if (others.empty()) return std::optional<std::string>();
  if (others.size() == catalog.entries().size()) {
    return fail(ErrorKind::bad_data,
                "{}: markers of family {} can't be found in images yet; bring a detections.csv",
                name, fmt::join(others, ", "));
  }
  return std::optional(fmt::format(
      "{}: markers of family {} can't be found in images yet; only a detections.csv shows them",
      name, fmt::join(others, ", ")));
}

}  // namespace waymark
