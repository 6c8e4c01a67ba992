#include "mapbuilder/diagnosis/view_placement.h"

#include <algorithm>
#include <vector>

namespace waymark {

std::optional<PlacementEstimate> place_at_size(std::span<const MarkerView> views, double factor,
                                               const BuildOptions& options) {
  constexpr std::size_t kMostViews = 48;
  const std::size_t count = std::min(views.size(), kMostViews);
  std::vector<MarkerObservation> observations;
  std::vector<PlacementView> placing;
  observations.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const MarkerView& view = views[i * views.size() / count];
    observations.push_back(*view.observation);
    MarkerObservation& o = observations.back();
    o.size_m *= factor;
    // IPPE's solutions scale with the size.
    if (o.ippe) {
      for (Rigid3& cam_from_marker : o.ippe->cam_from_marker) cam_from_marker.translation *= factor;
    }
    placing.push_back({&o, &view.camera->model, Rigid3{}, view.world_from_cam, std::nullopt});
  }
  if (placing.empty()) return std::nullopt;
  PlacementOptions placement = options.growth.placement;
  placement.loss = options.loss;
  return place_marker(placing, placement);
}

}  // namespace waymark
