#pragma once

#include <vector>

#include "mapbuilder/bundle/map_state.h"

namespace waymark {

/// Markers and frame sets with poses as vertices of one graph, the accepted observations between
/// them as its edges. Markers come first.
class AcceptedGraph {
 public:
  /// Of the given observations (table indices).
  AcceptedGraph(const ObservationTable& table, const std::vector<std::size_t>& observations,
                const MapState& state);

  [[nodiscard]] std::size_t vertex_of_marker(int marker) const {
    return static_cast<std::size_t>(marker);
  }
  [[nodiscard]] std::size_t vertex_of_frame_set(int frame_set) const {
    return markers_ + static_cast<std::size_t>(frame_set);
  }
  [[nodiscard]] bool is_marker(std::size_t vertex) const { return vertex < markers_; }
  /// Table index of the marker or frame set.
  [[nodiscard]] int index_of(std::size_t vertex) const {
    return static_cast<int>(is_marker(vertex) ? vertex : vertex - markers_);
  }
  [[nodiscard]] std::size_t size() const { return neighbours_.size(); }
  /// Vertices with a pose, rising.
  [[nodiscard]] const std::vector<std::size_t>& posed() const { return posed_; }
  [[nodiscard]] const std::vector<std::size_t>& neighbours(std::size_t vertex) const {
    return neighbours_[vertex];
  }

 private:
  std::size_t markers_;
  std::vector<std::vector<std::size_t>> neighbours_;
  std::vector<std::size_t> posed_;
};

/// Vertices that a depth-first walk entered one after the other: a subtree that hangs on the rest
/// by one marker, or by nothing.
struct HingedSpan {
  std::size_t first = 0;  ///< moment of entry
  std::size_t last = 0;   ///< inclusive
  int hinge = -1;         ///< table index of the marker; −1: none
};

/// A depth-first walk from an anchor, then from what it does not reach. Whatever one marker alone
/// connects with the anchor's side is a subtree of the walk (articulation points, Tarjan 1972).
/// The graph must outlive it.
class DepthFirstWalk {
 public:
  DepthFirstWalk(const AcceptedGraph& graph, std::size_t anchor);

  /// All hinged subtrees; the anchor is in none.
  [[nodiscard]] const std::vector<HingedSpan>& spans() const { return spans_; }
  [[nodiscard]] bool holds(const HingedSpan& span, std::size_t vertex) const {
    return span.first <= entered_[vertex] && entered_[vertex] <= span.last;
  }
  /// Markers and frame sets of a span, in order of entry.
  [[nodiscard]] Component vertices_of(const HingedSpan& span) const;

 private:
  void walk(std::size_t root);
  void enter(std::size_t vertex);

  const AcceptedGraph& graph_;
  std::vector<std::size_t> entered_;  ///< moment, per vertex
  std::vector<std::size_t> lowest_;   ///< earliest moment that the subtree is tied to
  std::vector<std::size_t> order_;    ///< vertex, per moment
  std::vector<HingedSpan> spans_;
};

}  // namespace waymark
