#include "mapbuilder/diagnosis/view_placement.h"

#include <algorithm>
#include <vector>

namespace waymark {

namespace {

/// Views as marker placement takes them: at most so many, evenly spread, as if of another size.
class PlacingViews {
 public:
  PlacingViews(std::span<const MarkerView> views, double factor) {
    constexpr std::size_t kMostViews = 48;
    const std::size_t count = std::min(views.size(), kMostViews);
    observations_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const MarkerView& view = views[i * views.size() / count];
      observations_.push_back(sized_as(view, factor * view.observation->size_m));
      placing_.push_back({&observations_.back(), &view.camera->model, Rigid3{}, view.world_from_cam,
                          std::nullopt});
    }
  }
  PlacingViews(const PlacingViews&) = delete;
  PlacingViews& operator=(const PlacingViews&) = delete;
  [[nodiscard]] std::span<const PlacementView> views() const { return placing_; }

 private:
  std::vector<MarkerObservation> observations_;
  std::vector<PlacementView> placing_;
};

}  // namespace

std::optional<PlacementEstimate> place_at_size(std::span<const MarkerView> views, double factor,
                                               const MapperOptions& options) {
  if (views.empty()) return std::nullopt;
  return place_marker(PlacingViews(views, factor).views(), options.growth.placement);
}

std::optional<PoseOptimum> refine_place(std::span<const MarkerView> views, const Rigid3& start,
                                        const MapperOptions& options) {
  const PlacingViews placing(views, 1.0);
  return minimize_pose(start, options.growth.placement.max_iterations, [&](const Rigid3& pose) {
    PoseEquations equations;
    for (const PlacementView& view : placing.views()) {
      add_observation(*view.observation,
                      {view.camera, view.cam_from_rig, view.world_from_rig, pose}, options.loss,
                      FreePose::marker, equations);
    }
    return equations;
  });
}

}  // namespace waymark
