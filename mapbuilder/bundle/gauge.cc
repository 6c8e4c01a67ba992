#include "mapbuilder/bundle/gauge.h"

#include <algorithm>

#include "mapbuilder/bundle/accepted_graph.h"

namespace waymark {
namespace {

/// Vertices that the given one reaches, by rising index; marks them as seen.
std::vector<std::size_t> reached_from(const AcceptedGraph& graph, std::size_t start,
                                      std::vector<char>& seen) {
  std::vector<std::size_t> reached{start};
  seen[start] = 1;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (const std::size_t next : graph.neighbours(reached[i])) {
      if (seen[next] != 0) continue;
      seen[next] = 1;
      reached.push_back(next);
    }
  }
  std::sort(reached.begin(), reached.end());
  return reached;
}

}  // namespace

ConstantPoses fix_gauge(const BundleProblem& problem,
                        std::span<const ObservationIndex> observations, const Estimate& estimate) {
  const AcceptedGraph graph(problem.prepared->observations(), observations, estimate);
  const auto is_fixed = [&](std::size_t vertex) {
    if (!graph.is_marker(vertex)) return problem.constant.holds(graph.frame_set_of(vertex));
    const MarkerIndex marker = graph.marker_of(vertex);
    return problem.constant.holds(marker) || problem.scope.in_facility(marker);
  };
  ConstantPoses all = problem.constant;
  std::vector<char> seen(graph.size(), 0);
  for (const std::size_t vertex : graph.posed()) {
    if (seen[vertex] != 0) continue;
    const std::vector<std::size_t> component = reached_from(graph, vertex, seen);
    if (std::any_of(component.begin(), component.end(), is_fixed)) continue;
    const auto frame_set = std::find_if(component.begin(), component.end(),
                                        [&](std::size_t v) { return !graph.is_marker(v); });
    if (frame_set != component.end()) all.frame_sets.push_back(graph.frame_set_of(*frame_set));
  }
  return all;
}

}  // namespace waymark
