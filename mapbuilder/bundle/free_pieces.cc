#include "mapbuilder/bundle/free_pieces.h"

#include <algorithm>

#include "mapbuilder/bundle/accepted_graph.h"
#include "mapbuilder/bundle/joint_adjustment.h"

namespace waymark {
namespace {

/// Vertices that the given one reaches, by rising index; marks them as seen.
std::vector<std::size_t> piece_of(const AcceptedGraph& graph, std::size_t start,
                                  std::vector<char>& seen) {
  std::vector<std::size_t> piece{start};
  seen[start] = 1;
  for (std::size_t i = 0; i < piece.size(); ++i) {
    for (const std::size_t next : graph.neighbours(piece[i])) {
      if (seen[next] != 0) continue;
      seen[next] = 1;
      piece.push_back(next);
    }
  }
  std::sort(piece.begin(), piece.end());
  return piece;
}

}  // namespace

HeldPoses hold_free_pieces(const ObservationTable& table,
                           const std::vector<std::size_t>& observations,
                           const AdjustmentScope& scope, const MapState& state,
                           const HeldPoses& held) {
  const AcceptedGraph graph(table, observations, state);
  const auto is_tied = [&](std::size_t vertex) {
    const int index = graph.index_of(vertex);
    return graph.is_marker(vertex) ? held.holds_marker(index) || scope.in_facility(index)
                                   : held.holds_frame_set(index);
  };
  HeldPoses all = held;
  std::vector<char> seen(graph.size(), 0);
  for (const std::size_t vertex : graph.posed()) {
    if (seen[vertex] != 0) continue;
    const std::vector<std::size_t> piece = piece_of(graph, vertex, seen);
    if (std::any_of(piece.begin(), piece.end(), is_tied)) continue;
    const auto frame_set = std::find_if(piece.begin(), piece.end(),
                                        [&](std::size_t v) { return !graph.is_marker(v); });
    if (frame_set != piece.end()) all.frame_sets.push_back(graph.index_of(*frame_set));
  }
  return all;
}

}  // namespace waymark
