#include "mapbuilder/bundle/accepted_graph.h"

#include <algorithm>
#include <random>
#include <set>

#include "tests/mapbuilder/observations/bare_observations.h"

namespace waymark {
namespace {

using Vertices = std::set<std::size_t>;

/// What the vertex reaches without passing `without`.
Vertices reached(const AcceptedGraph& graph, std::size_t from, std::size_t without) {
  Vertices seen{from};
  std::vector<std::size_t> open{from};
  while (!open.empty()) {
    const std::size_t here = open.back();
    open.pop_back();
    for (const std::size_t next : graph.neighbours(here)) {
      if (next != without && seen.insert(next).second) open.push_back(next);
    }
  }
  return seen;
}

/// The vertices of every span with its hinge, as the walk has them.
std::set<std::pair<std::size_t, Vertices>> spans_of(const AcceptedGraph& graph,
                                                    const DepthFirstWalk& walk) {
  std::set<std::pair<std::size_t, Vertices>> spans;
  for (const HingedSpan& span : walk.spans()) {
    Vertices vertices;
    const Component held = walk.vertices_of(span);
    for (const MarkerIndex m : held.markers) vertices.insert(graph.vertex_of(m));
    for (const FrameSetIndex f : held.frame_sets) vertices.insert(graph.vertex_of(f));
    for (const std::size_t vertex : graph.posed()) {
      EXPECT_EQ(walk.holds(span, vertex), vertices.contains(vertex));
    }
    spans.emplace(span.hinge ? graph.vertex_of(*span.hinge) : graph.size(), vertices);
  }
  return spans;
}

/// The same by taking out one marker after the other.
std::set<std::pair<std::size_t, Vertices>> spans_by_hand(const AcceptedGraph& graph,
                                                         std::size_t anchor) {
  std::set<std::pair<std::size_t, Vertices>> spans;
  const std::size_t nothing = graph.size();
  std::vector<std::size_t> roots{anchor};
  Vertices known = reached(graph, anchor, nothing);
  for (const std::size_t vertex : graph.posed()) {
    if (known.contains(vertex)) continue;
    const Vertices component = reached(graph, vertex, nothing);
    spans.emplace(nothing, component);
    known.insert(component.begin(), component.end());
    roots.push_back(vertex);
  }
  for (const std::size_t root : roots) {
    for (const std::size_t hinge : reached(graph, root, nothing)) {
      if (!graph.is_marker(hinge) || hinge == root) continue;
      const Vertices near = reached(graph, root, hinge);
      for (const std::size_t frame_set : graph.neighbours(hinge)) {
        if (!near.contains(frame_set)) spans.emplace(hinge, reached(graph, frame_set, hinge));
      }
    }
  }
  return spans;
}

TEST(AcceptedGraph, TheWalkFindsWhatHangsOnOneMarkerInAnyGraph) {
  std::mt19937 random(5);
  const auto up_to = [&](std::size_t most) { return random() % (most + 1); };
  for (int trial = 0; trial < 300; ++trial) {
    const std::size_t markers = 1 + up_to(9);
    const std::size_t frame_sets = 1 + up_to(9);
    std::set<std::pair<std::size_t, std::size_t>> edges{{0, up_to(markers - 1)}};
    for (std::size_t i = up_to(markers + frame_sets + 4); i > 0; --i) {
      edges.emplace(up_to(frame_sets - 1), up_to(markers - 1));
    }
    const Observations observations =
        test::bare_observations({edges.begin(), edges.end()}, frame_sets, markers);
    const Selection selection(observations);
    Estimate estimate(selection, NoiseModel{});
    for (auto& marker : estimate.world_from_marker) marker = Rigid3{};
    for (auto& rig : estimate.world_from_rig) rig = RigPoseEstimate{};
    for (char& accepted : estimate.accepted) accepted = up_to(9) > 0 ? 1 : 0;
    const AcceptedGraph graph(observations, selection.used(), estimate);
    const std::size_t anchor = graph.vertex_of(FrameSetIndex(0));
    EXPECT_EQ(spans_of(graph, DepthFirstWalk(graph, anchor)), spans_by_hand(graph, anchor))
        << "trial " << trial;
  }
}

}  // namespace
}  // namespace waymark
