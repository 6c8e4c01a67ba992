#include "mapbuilder/bundle/accepted_graph.h"

#include <algorithm>
#include <limits>

namespace waymark {
namespace {

constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

}  // namespace

AcceptedGraph::AcceptedGraph(const Observations& all,
                             std::span<const ObservationIndex> observations,
                             const Estimate& estimate)
    : markers_(all.markers.size()), neighbours_(markers_ + all.frame_sets.size()) {
  std::vector<char> is_posed(neighbours_.size(), 0);
  for (const ObservationIndex index : observations) {
    const Observation& o = all[index];
    if (!estimate.posed(o)) continue;
    const std::size_t marker = vertex_of(o.marker);
    const std::size_t frame_set = vertex_of(o.frame_set);
    is_posed[marker] = is_posed[frame_set] = 1;
    if (!estimate.accepts(index)) continue;
    neighbours_[marker].push_back(frame_set);
    neighbours_[frame_set].push_back(marker);
  }
  for (std::size_t vertex = 0; vertex < is_posed.size(); ++vertex) {
    if (is_posed[vertex] != 0) posed_.push_back(vertex);
  }
}

DepthFirstWalk::DepthFirstWalk(const AcceptedGraph& graph, std::size_t anchor)
    : graph_(graph), entered_(graph.size(), kNever), lowest_(graph.size(), kNever) {
  walk(anchor);
  for (const std::size_t vertex : graph.posed()) {
    if (entered_[vertex] != kNever) continue;
    const std::size_t first = order_.size();
    walk(vertex);
    spans_.push_back({first, order_.size() - 1, std::nullopt});
  }
}

void DepthFirstWalk::enter(std::size_t vertex) {
  entered_[vertex] = lowest_[vertex] = order_.size();
  order_.push_back(vertex);
}

// Without recursion: a building's walk is as deep as its frame sets are many.
void DepthFirstWalk::walk(std::size_t root) {
  struct Step {
    std::size_t vertex;
    std::size_t parent;
    std::size_t next = 0;  // neighbour to look at
  };
  std::vector<Step> path{{root, kNever}};
  enter(root);
  while (!path.empty()) {
    Step& step = path.back();
    const auto& neighbours = graph_.neighbours(step.vertex);
    if (step.next < neighbours.size()) {
      const std::size_t next = neighbours[step.next++];
      if (next == step.parent) continue;
      if (entered_[next] == kNever) {
        path.push_back({next, step.vertex});
        enter(next);
      } else {
        lowest_[step.vertex] = std::min(lowest_[step.vertex], entered_[next]);
      }
      continue;
    }
    const Step done = step;
    path.pop_back();
    if (path.empty()) break;
    lowest_[done.parent] = std::min(lowest_[done.parent], lowest_[done.vertex]);
    // A root that is a marker has nothing above it to hang on.
    if (graph_.is_marker(done.parent) && done.parent != root &&
        lowest_[done.vertex] >= entered_[done.parent]) {
      spans_.push_back({entered_[done.vertex], order_.size() - 1, graph_.marker_of(done.parent)});
    }
  }
}

Component DepthFirstWalk::vertices_of(const HingedSpan& span) const {
  Component span_vertices;
  for (std::size_t moment = span.first; moment <= span.last; ++moment) {
    const std::size_t vertex = order_[moment];
    if (graph_.is_marker(vertex)) {
      span_vertices.markers.push_back(graph_.marker_of(vertex));
    } else {
      span_vertices.frame_sets.push_back(graph_.frame_set_of(vertex));
    }
  }
  return span_vertices;
}

}  // namespace waymark
