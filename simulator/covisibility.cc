#include "simulator/covisibility.h"

#include "core/base/disjoint_sets.h"

namespace waymark::simulator {
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
        sets.unite(seen.marker, scene.markers.size() + node);
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
