#include "mapbuilder/growth/placement_views.h"

#include <algorithm>

#include "core/base/parallel.h"

namespace waymark {
namespace {

/// Half of the views are the largest, for precision; half are spread over the smaller ones, for
/// variety. By size alone, so that neither stamps nor order decide.
void thin_out(const PreparedObservations& prepared, std::size_t most,
              std::vector<ObservationIndex>& views) {
  if (views.size() <= most) return;
  std::stable_sort(views.begin(), views.end(), [&](ObservationIndex a, ObservationIndex b) {
    return area_px2(prepared[a].corners_px) > area_px2(prepared[b].corners_px);
  });
  const std::size_t largest = most / 2;
  const std::size_t spread = most - largest;
  for (std::size_t i = 0; i < spread; ++i) {
    views[largest + i] = views[largest + i * (views.size() - largest) / spread];
  }
  views.resize(most);
}

}  // namespace

std::vector<PlacementView> placement_views(const PreparedObservations& prepared,
                                           const Estimate& estimate, MarkerIndex marker,
                                           std::size_t most, const FrameSetFilter& filter) {
  const Observations& all = prepared.observations();
  const auto collect = [&](bool accepted_only) {
    std::vector<ObservationIndex> usable;
    for (const ObservationIndex index : prepared.selection().used_of(marker)) {
      const FrameSetIndex frame_set = all[index].frame_set;
      if ((estimate.accepts(index) || !accepted_only) && estimate.world_from_rig[frame_set] &&
          filter(frame_set)) {
        usable.push_back(index);
      }
    }
    return usable;
  };
  // A marker between two places that it was seen at has no accepted view: it is placed anew by all.
  std::vector<ObservationIndex> usable = collect(true);
  if (usable.empty()) usable = collect(false);
  thin_out(prepared, most, usable);
  std::vector<PlacementView> views;
  views.reserve(usable.size());
  for (const ObservationIndex index : usable) {
    const RigCamera& camera = estimate.calibration.camera(all, all[index]);
    const RigPoseEstimate& rig = *estimate.world_from_rig[all[index].frame_set];
    PlacementView view{&prepared[index], &camera.model, camera.rig_from_cam.inverse(),
                       rig.best.pose, std::nullopt};
    if (rig.ambiguous) view.other_world_from_rig = rig.runner_up->pose;
    views.push_back(view);
  }
  return views;
}

std::vector<std::optional<PlacementEstimate>> place_markers(const PreparedObservations& prepared,
                                                            const Estimate& estimate,
                                                            std::span<const MarkerIndex> markers,
                                                            const FrameSetFilter& filter,
                                                            const MapperOptions& options) {
  const auto most = static_cast<std::size_t>(options.growth.max_placement_views);
  std::vector<std::optional<PlacementEstimate>> placed(markers.size());
  parallel_for(markers.size(), options.threads, [&](std::size_t i) {
    const auto views = placement_views(prepared, estimate, markers[i], most, filter);
    if (!views.empty()) placed[i] = place_marker(views, options.growth.placement);
  });
  return placed;
}

}  // namespace waymark
