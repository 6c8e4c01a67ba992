#include "mapbuilder/growth/misplaced_subgraphs.h"

#include <algorithm>
#include <set>

#include "core/marker/marker_geometry.h"
#include "mapbuilder/bundle/accepted_graph.h"

namespace waymark {
namespace {

/// A rejected observation between a subgraph and the rest.
struct Link {
  ObservationIndex index;
  bool frame_set_moves = false;  ///< else its marker
};

/// cam_from_marker of a link when the subgraph has moved.
Rigid3 moved_cam_from_marker(const Observations& all, const Estimate& estimate, const Link& link,
                             const Rigid3& new_from_old) {
  const Observation& o = all[link.index];
  const Rigid3& rig = estimate.world_from_rig[o.frame_set]->best.pose;
  const Rigid3& marker = *estimate.world_from_marker[o.marker];
  const Rigid3 rig_from_marker = link.frame_set_moves
                                     ? rig.inverse() * (new_from_old.inverse() * marker)
                                     : rig.inverse() * (new_from_old * marker);
  return estimate.calibration.camera(all, o).rig_from_cam.inverse() * rig_from_marker;
}

/// Where the subgraph would have to be for the link to show its marker at `cam_from_marker`.
Rigid3 explaining(const Observations& all, const Estimate& estimate, const Link& link,
                  const Rigid3& cam_from_marker) {
  const Observation& o = all[link.index];
  const Rigid3& rig = estimate.world_from_rig[o.frame_set]->best.pose;
  const Rigid3& marker = *estimate.world_from_marker[o.marker];
  const Rigid3 rig_from_marker = estimate.calibration.camera(all, o).rig_from_cam * cam_from_marker;
  return link.frame_set_moves ? marker * rig_from_marker.inverse() * rig.inverse()
                              : rig * rig_from_marker * marker.inverse();
}

/// Whether the corners lie within half a side of where they should: a place that one view of a
/// small marker tells is no more exact, far from it.
bool fits(const PreparedObservations& prepared, const Estimate& estimate, const Link& link,
          const Rigid3& new_from_old) {
  constexpr double kReach = 0.5;
  const Observations& all = prepared.observations();
  const auto residuals = corner_residuals(prepared[link.index],
                                          estimate.calibration.camera(all, all[link.index]).model,
                                          moved_cam_from_marker(all, estimate, link, new_from_old));
  if (!residuals) return false;
  double sum = 0;
  for (const Eigen::Vector2d& residual : *residuals) sum += residual.squaredNorm();
  return 0.25 * sum < kReach * kReach * area_px2(prepared[link.index].corners_px);
}

/// The place that the links of most markers agree on; false where fewer than two do.
bool agree(const PreparedObservations& prepared, const Estimate& estimate,
           const std::vector<Link>& links, MisplacedSubgraph& misplaced) {
  constexpr std::size_t kMostHypotheses = 64;
  constexpr std::size_t kLeastLinks = 3;
  constexpr std::size_t kLeastMarkers = 2;
  const std::size_t hypotheses = std::min(links.size(), kMostHypotheses);
  for (std::size_t i = 0; i < hypotheses; ++i) {
    const Link& link = links[i * links.size() / hypotheses];
    const MarkerObservation& from = prepared[link.index];
    if (!from.ippe) continue;
    for (const Rigid3& cam_from_marker : from.ippe->cam_from_marker) {
      const Rigid3 there = explaining(prepared.observations(), estimate, link, cam_from_marker);
      std::vector<ObservationIndex> fitting;
      std::set<MarkerIndex> markers;
      for (const Link& other : links) {
        if (!fits(prepared, estimate, other, there)) continue;
        fitting.push_back(other.index);
        markers.insert(prepared.observations()[other.index].marker);
      }
      if (std::pair(markers.size(), fitting.size()) <=
          std::pair(misplaced.markers, misplaced.links.size())) {
        continue;
      }
      misplaced.new_from_old = there;
      misplaced.links = std::move(fitting);
      misplaced.markers = markers.size();
    }
  }
  return misplaced.markers >= kLeastMarkers && misplaced.links.size() >= kLeastLinks;
}

/// What a span holds. Its hinge goes along when more of its accepted views are in there.
Component subgraph_of(const AcceptedGraph& graph, const DepthFirstWalk& walk,
                      const HingedSpan& span) {
  Component subgraph = walk.vertices_of(span);
  if (span.hinge) {
    const auto& views = graph.neighbours(graph.vertex_of(*span.hinge));
    const auto inside = std::count_if(views.begin(), views.end(), [&](std::size_t frame_set) {
      return walk.holds(span, frame_set);
    });
    if (2 * static_cast<std::size_t>(inside) > views.size()) {
      subgraph.markers.push_back(*span.hinge);
    }
  }
  std::sort(subgraph.markers.begin(), subgraph.markers.end());
  std::sort(subgraph.frame_sets.begin(), subgraph.frame_sets.end());
  return subgraph;
}

/// The observations with a rejected prediction.
std::vector<ObservationIndex> rejected_of(const Observations& all,
                                          std::span<const ObservationIndex> observations,
                                          const Estimate& estimate) {
  std::vector<ObservationIndex> rejected;
  for (const ObservationIndex index : observations) {
    if (estimate.posed(all[index]) && !estimate.accepts(index)) rejected.push_back(index);
  }
  return rejected;
}

/// Different markers with a rejected observation.
std::size_t contradicting_markers(const Observations& all,
                                  std::span<const ObservationIndex> observations,
                                  const Estimate& estimate) {
  std::set<MarkerIndex> markers;
  for (const ObservationIndex index : rejected_of(all, observations, estimate)) {
    markers.insert(all[index].marker);
  }
  return markers.size();
}

/// The rejected observations between a span and the rest, but those of its hinge.
std::vector<Link> links_of(const Observations& all, const AcceptedGraph& graph,
                           const DepthFirstWalk& walk, const HingedSpan& span,
                           std::span<const ObservationIndex> rejected) {
  std::vector<Link> links;
  for (const ObservationIndex index : rejected) {
    const Observation& o = all[index];
    if (o.marker == span.hinge) continue;
    const bool marker_inside = walk.holds(span, graph.vertex_of(o.marker));
    const bool frame_set_inside = walk.holds(span, graph.vertex_of(o.frame_set));
    if (marker_inside != frame_set_inside) links.push_back({index, frame_set_inside});
  }
  return links;
}

/// The estimate with the subgraph in its new place; its links are accepted, the hinge's
/// observations across no more.
Estimate moved(const Selection& selection, const MisplacedSubgraph& misplaced, Estimate estimate) {
  move_poses(misplaced.subgraph, misplaced.new_from_old, estimate);
  for (const ObservationIndex index : misplaced.links) estimate.accepted[index] = 1;
  if (!misplaced.hinge) return estimate;
  const Component& subgraph = misplaced.subgraph;
  const std::set<FrameSetIndex> frame_sets(subgraph.frame_sets.begin(), subgraph.frame_sets.end());
  const bool hinge_moved =
      std::binary_search(subgraph.markers.begin(), subgraph.markers.end(), *misplaced.hinge);
  for (const ObservationIndex index : selection.used_of(*misplaced.hinge)) {
    if (frame_sets.contains(selection[index].frame_set) != hinge_moved) {
      estimate.accepted[index] = 0;
    }
  }
  return estimate;
}

}  // namespace

std::vector<MisplacedSubgraph> find_misplaced_subgraphs(
    const PreparedObservations& prepared, std::span<const ObservationIndex> observations,
    FrameSetIndex anchor, const Estimate& estimate) {
  const Observations& all = prepared.observations();
  const std::vector<ObservationIndex> rejected = rejected_of(all, observations, estimate);
  std::vector<MisplacedSubgraph> found;
  if (rejected.empty()) return found;
  const AcceptedGraph graph(all, observations, estimate);
  const DepthFirstWalk walk(graph, graph.vertex_of(anchor));
  for (const HingedSpan& span : walk.spans()) {
    MisplacedSubgraph misplaced;
    misplaced.hinge = span.hinge;
    if (!agree(prepared, estimate, links_of(all, graph, walk, span, rejected), misplaced)) continue;
    misplaced.subgraph = subgraph_of(graph, walk, span);
    found.push_back(std::move(misplaced));
  }
  std::stable_sort(
      found.begin(), found.end(), [](const MisplacedSubgraph& a, const MisplacedSubgraph& b) {
        return std::pair(a.markers, a.links.size()) > std::pair(b.markers, b.links.size());
      });
  return found;
}

Estimate move_misplaced_subgraphs(const IncrementalMapper& mapper, ComponentIndex component,
                                  Estimate estimate, Progress& progress) {
  constexpr int kMostFailures = 12;
  // A place that is right explains more without calling more of it noise.
  constexpr double kMostNoiseGrowth = 1.1;
  const Observations& all = mapper.selection().observations();
  const std::vector<ObservationIndex> observations =
      mapper.observations_of(std::span(&component, 1));
  const auto sigma_px = [&](const Estimate& of) {
    return of.components[component].noise.model_sigma_px;
  };
  std::set<std::vector<FrameSetIndex>> in_vain;
  for (int failures = 0; failures < kMostFailures;) {
    std::vector<MisplacedSubgraph> found = find_misplaced_subgraphs(
        mapper.prepared(estimate), observations, mapper.seed_of(component), estimate);
    std::erase_if(found, [&](const MisplacedSubgraph& misplaced) {
      return in_vain.contains(misplaced.subgraph.frame_sets);
    });
    if (found.empty()) break;
    Estimate tried = mapper
                         .converge({{component}, {}},
                                   moved(mapper.selection(), found.front(), estimate), progress)
                         .estimate;
    // Each success lowers a count that can't fall for ever.
    if (contradicting_markers(all, observations, tried) <
            contradicting_markers(all, observations, estimate) &&
        sigma_px(tried) <= kMostNoiseGrowth * sigma_px(estimate)) {
      estimate = std::move(tried);
      in_vain.clear();
    } else {
      in_vain.insert(found.front().subgraph.frame_sets);
      ++failures;
    }
  }
  return estimate;
}

}  // namespace waymark
