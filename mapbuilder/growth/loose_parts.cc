#include "mapbuilder/growth/loose_parts.h"

#include <algorithm>
#include <set>

#include "core/marker/marker_geometry.h"
#include "mapbuilder/bundle/accepted_graph.h"
#include "mapbuilder/growth/build_snapshot.h"

namespace waymark {
namespace {

/// A rejected observation between a part and the rest.
struct Link {
  std::size_t index = 0;
  bool frame_set_moves = false;  ///< else its marker
};

/// cam_from_marker of a link when the part has moved.
Rigid3 moved_cam_from_marker(const ObservationTable& table, const MapState& state, const Link& link,
                             const Rigid3& new_from_old) {
  const TableObservation& o = table.observations[link.index];
  const Rigid3& rig = state.rigs[static_cast<std::size_t>(o.frame_set)]->best.pose;
  const Rigid3& marker = *state.world_from_marker[static_cast<std::size_t>(o.marker)];
  const Rigid3 rig_from_marker = link.frame_set_moves
                                     ? rig.inverse() * (new_from_old.inverse() * marker)
                                     : rig.inverse() * (new_from_old * marker);
  return camera_of(table, o).rig_from_cam.inverse() * rig_from_marker;
}

/// Where the part would have to be for the link to show its marker at `cam_from_marker`.
Rigid3 explaining(const ObservationTable& table, const MapState& state, const Link& link,
                  const Rigid3& cam_from_marker) {
  const TableObservation& o = table.observations[link.index];
  const Rigid3& rig = state.rigs[static_cast<std::size_t>(o.frame_set)]->best.pose;
  const Rigid3& marker = *state.world_from_marker[static_cast<std::size_t>(o.marker)];
  const Rigid3 rig_from_marker = camera_of(table, o).rig_from_cam * cam_from_marker;
  return link.frame_set_moves ? marker * rig_from_marker.inverse() * rig.inverse()
                              : rig * rig_from_marker * marker.inverse();
}

/// Whether the corners lie within half a side of where they should: a place that one view of a
/// small marker tells is no more exact, far from it.
bool fits(const ObservationTable& table, const MapState& state, const Link& link,
          const Rigid3& new_from_old) {
  constexpr double kReach = 0.5;
  const TableObservation& o = table.observations[link.index];
  const auto residuals = corner_residuals(o, camera_of(table, o).model,
                                          moved_cam_from_marker(table, state, link, new_from_old));
  if (!residuals) return false;
  double sum = 0;
  for (const Eigen::Vector2d& residual : *residuals) sum += residual.squaredNorm();
  return 0.25 * sum < kReach * kReach * area_px2(o.corners_px);
}

/// The place that the links of most markers agree on; false where fewer than two do.
bool agree(const ObservationTable& table, const MapState& state, const std::vector<Link>& links,
           LoosePart& loose) {
  constexpr std::size_t kMostHypotheses = 64;
  constexpr std::size_t kLeastLinks = 3;
  constexpr std::size_t kLeastMarkers = 2;
  const std::size_t hypotheses = std::min(links.size(), kMostHypotheses);
  for (std::size_t i = 0; i < hypotheses; ++i) {
    const Link& link = links[i * links.size() / hypotheses];
    const TableObservation& from = table.observations[link.index];
    if (!from.ippe) continue;
    for (const Rigid3& cam_from_marker : from.ippe->cam_from_marker) {
      const Rigid3 there = explaining(table, state, link, cam_from_marker);
      std::vector<std::size_t> fitting;
      std::set<int> markers;
      for (const Link& other : links) {
        if (!fits(table, state, other, there)) continue;
        fitting.push_back(other.index);
        markers.insert(table.observations[other.index].marker);
      }
      if (std::pair(markers.size(), fitting.size()) <=
          std::pair(loose.markers, loose.links.size())) {
        continue;
      }
      loose.new_from_old = there;
      loose.links = std::move(fitting);
      loose.markers = markers.size();
    }
  }
  return loose.markers >= kLeastMarkers && loose.links.size() >= kLeastLinks;
}

/// What a span holds. Its hinge goes along when more of its accepted views are in there.
Component part_of(const AcceptedGraph& graph, const DepthFirstWalk& walk, const HingedSpan& span) {
  Component part = walk.vertices_of(span);
  if (span.hinge >= 0) {
    const auto& views = graph.neighbours(graph.vertex_of_marker(span.hinge));
    const auto inside = std::count_if(views.begin(), views.end(), [&](std::size_t frame_set) {
      return walk.holds(span, frame_set);
    });
    if (2 * static_cast<std::size_t>(inside) > views.size()) part.markers.push_back(span.hinge);
  }
  std::sort(part.markers.begin(), part.markers.end());
  std::sort(part.frame_sets.begin(), part.frame_sets.end());
  return part;
}

/// Different markers of the build with a rejected observation.
std::size_t contradicting_markers(const JointBuild& build) {
  std::set<int> markers;
  for (const std::size_t index : build.observations()) {
    const TableObservation& o = build.table().observations[index];
    if (build.state().posed(o) && build.state().accepted[index] == 0) markers.insert(o.marker);
  }
  return markers.size();
}

void rehang(const LoosePart& loose, JointBuild& build) {
  MapState& state = build.state();
  move_poses(loose.part, loose.new_from_old, state);
  for (const std::size_t index : loose.links) state.accepted[index] = 1;
  if (loose.hinge < 0) return;
  const std::set<int> moved(loose.part.frame_sets.begin(), loose.part.frame_sets.end());
  const bool hinge_moved =
      std::binary_search(loose.part.markers.begin(), loose.part.markers.end(), loose.hinge);
  for (const std::size_t index :
       build.table().observations_of_marker[static_cast<std::size_t>(loose.hinge)]) {
    const TableObservation& o = build.table().observations[index];
    if (moved.contains(o.frame_set) != hinge_moved) state.accepted[index] = 0;
  }
}

}  // namespace

std::vector<LoosePart> find_loose_parts(const ObservationTable& table,
                                        const std::vector<std::size_t>& observations, int anchor,
                                        const MapState& state) {
  std::vector<std::size_t> rejected;
  for (const std::size_t index : observations) {
    if (state.posed(table.observations[index]) && state.accepted[index] == 0) {
      rejected.push_back(index);
    }
  }
  std::vector<LoosePart> parts;
  if (rejected.empty()) return parts;
  const AcceptedGraph graph(table, observations, state);
  const DepthFirstWalk walk(graph, graph.vertex_of_frame_set(anchor));
  for (const HingedSpan& span : walk.spans()) {
    std::vector<Link> links;
    for (const std::size_t index : rejected) {
      const TableObservation& o = table.observations[index];
      if (o.marker == span.hinge) continue;
      const bool marker_inside = walk.holds(span, graph.vertex_of_marker(o.marker));
      const bool frame_set_inside = walk.holds(span, graph.vertex_of_frame_set(o.frame_set));
      if (marker_inside != frame_set_inside) links.push_back({index, frame_set_inside});
    }
    LoosePart loose;
    loose.hinge = span.hinge;
    if (!agree(table, state, links, loose)) continue;
    loose.part = part_of(graph, walk, span);
    parts.push_back(std::move(loose));
  }
  std::stable_sort(parts.begin(), parts.end(), [](const LoosePart& a, const LoosePart& b) {
    return std::pair(a.markers, a.links.size()) > std::pair(b.markers, b.links.size());
  });
  return parts;
}

void rehang_loose_parts(JointBuild& build) {
  constexpr int kMostFailures = 12;
  // A place that is right explains more without calling more of it noise.
  constexpr double kMostNoiseGrowth = 1.1;
  const ComponentGrowth& growth = *build.parts().front();
  std::set<std::vector<int>> in_vain;  // by their frame sets
  for (int failures = 0; failures < kMostFailures;) {
    std::vector<LoosePart> parts =
        find_loose_parts(build.table(), build.observations(), growth.anchor(), build.state());
    std::erase_if(parts,
                  [&](const LoosePart& loose) { return in_vain.contains(loose.part.frame_sets); });
    if (parts.empty()) break;
    const std::size_t contradicting = contradicting_markers(build);
    const double sigma_px = growth.noise().model_sigma_px;
    BuildSnapshot snapshot(build);
    rehang(parts.front(), build);
    build.settle();
    // Each success lowers a count that can't fall for ever.
    if (contradicting_markers(build) < contradicting &&
        growth.noise().model_sigma_px <= kMostNoiseGrowth * sigma_px) {
      in_vain.clear();
    } else {
      snapshot.restore();
      in_vain.insert(parts.front().part.frame_sets);
      ++failures;
    }
  }
}

}  // namespace waymark
