#include "simulator/covisibility.h"

#include <numeric>

namespace waymark::simulator {
namespace {

/// Sets that are merged and looked up.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void merge(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace

std::vector<Rigid3> standing_positions(const Scene& scene, int count) {
  const Trajectory way(scene.trajectory);
  std::vector<Rigid3> poses;
  for (int i = 0; i < count; ++i) poses.push_back(way.world_from_cam0(way.length_m() * i / count));
  return poses;
}

DetectionGraph detection_graph(const Scene& scene, const SimulatedRig& rig,
                               const VisibilityLimits& limits) {
  const Visibility visibility(scene, limits);
  const auto positions = standing_positions(scene, scene.trajectory.positions);
  const std::size_t cameras = rig.rig.cameras.size();
  const std::size_t nodes = rig.mono ? positions.size() * cameras : positions.size();
  DisjointSets sets(scene.markers.size() + nodes);
  std::vector<int> nodes_of_marker(scene.markers.size(), 0);
  DetectionGraph graph;
  for (std::size_t position = 0; position < positions.size(); ++position) {
    std::vector<bool> counted(scene.markers.size(), false);
    for (std::size_t camera = 0; camera < cameras; ++camera) {
      const RigCamera& mounted = rig.rig.cameras[camera];
      const auto visible = visibility.visible_from(
          mounted.model, world_from_rig(rig.rig, positions[position]) * mounted.rig_from_cam);
      const std::size_t node = rig.mono ? position * cameras + camera : position;
      ++graph.images;
      graph.empty_images += visible.empty() ? 1 : 0;
      graph.one_marker_images += visible.size() == 1 ? 1 : 0;
      graph.observations += static_cast<int>(visible.size());
      for (const VisibleMarker& seen : visible) {
        sets.merge(seen.marker, scene.markers.size() + node);
        if (rig.mono || !counted[seen.marker]) ++nodes_of_marker[seen.marker];
        counted[seen.marker] = true;
      }
    }
  }
  std::vector<bool> is_root(scene.markers.size() + nodes, false);
  for (std::size_t i = 0; i < scene.markers.size(); ++i) {
    if (nodes_of_marker[i] > 0) is_root[sets.find(i)] = true;
    graph.unseen_markers += nodes_of_marker[i] == 0 ? 1 : 0;
    graph.markers_seen_once += nodes_of_marker[i] == 1 ? 1 : 0;
  }
  for (const bool root : is_root) graph.components += root ? 1 : 0;
  return graph;
}

}  // namespace waymark::simulator
