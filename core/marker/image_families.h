#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// The families of a catalog whose markers are found in images. Those of the others
/// (is_found_in_images) are known from a detections.csv alone: they may stand beside the first, in
/// a catalog as in a map, and no image ever shows one.
[[nodiscard]] std::vector<Family> families_in_images(const MarkerCatalog& catalog);

/// What images will show of a catalog: bad_data when none of its families, a note about those that
/// they don't, nothing when they show all. `name` stands for catalog or capture in messages.
[[nodiscard]] Expected<std::optional<std::string>> shown_in_images(const MarkerCatalog& catalog,
                                                                   const std::string& name);

}  // namespace waymark
