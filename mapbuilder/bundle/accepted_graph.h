#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mapbuilder/bundle/estimate.h"

namespace waymark {

/// Markers and frame sets with poses as vertices of one graph, the accepted observations between
/// them as its edges. Markers come first.
class AcceptedGraph {
 public:
  /// Of the given observations.
  AcceptedGraph(const Observations& all, std::span<const ObservationIndex> observations,
                const Estimate& estimate);

  [[nodiscard]] std::size_t vertex_of(MarkerIndex marker) const { return marker.value(); }
  [[nodiscard]] std::size_t vertex_of(FrameSetIndex frame_set) const {
    return markers_ + frame_set.value();
  }
  [[nodiscard]] bool is_marker(std::size_t vertex) const { return vertex < markers_; }
  [[nodiscard]] MarkerIndex marker_of(std::size_t vertex) const { return MarkerIndex(vertex); }
  [[nodiscard]] FrameSetIndex frame_set_of(std::size_t vertex) const {
    return FrameSetIndex(vertex - markers_);
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
  std::size_t first = 0;             ///< moment of entry
  std::size_t last = 0;              ///< inclusive
  std::optional<MarkerIndex> hinge;  ///< the marker it hangs on
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
