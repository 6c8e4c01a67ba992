#pragma once

#include "core/map/marker_map.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// The catalog with the sizes that a map was built with in place of those stated, where a survey or
/// a refinement has changed them: of its markers as long as the catalog states for them what was
/// stated then, and of all others of one of its stated sizes by the same factor (there is one
/// factor per stated size). Where nothing was changed, the catalog as it is.
[[nodiscard]] MarkerCatalog with_sizes_of(const MarkerMap& map, const MarkerCatalog& catalog);

}  // namespace waymark
