#pragma once

#include <map>
#include <optional>
#include <vector>

#include "mapbuilder/build/map_builder.h"

namespace waymark {

/// One sub-map that was built of a round alone.
struct RoundPart {
  std::size_t submap = 0;    ///< of the build's result
  ComponentIndex component;  ///< of the round's selection
  /// The build's estimate to its map's world.
  Rigid3 world_from_estimate;
};

/// A round over a building with the map that it gives by itself: what that rests on, ready to be
/// adjusted again together with what an earlier map knows. Observations and result must outlive it.
class RoundParts {
 public:
  RoundParts(const Observations& observations, const BuildResult& result,
             const MapperOptions& options);
  RoundParts(const RoundParts&) = delete;
  RoundParts& operator=(const RoundParts&) = delete;

  [[nodiscard]] const BuildResult& result() const { return result_; }
  [[nodiscard]] const Observations& observations() const { return selection_.observations(); }
  /// Of the observations that the map rests on.
  [[nodiscard]] const Selection& selection() const { return selection_; }
  [[nodiscard]] const PreparedObservations& prepared() const { return prepared_; }
  /// The build's, everything in the selection accepted.
  [[nodiscard]] const Estimate& estimate() const { return estimate_; }
  [[nodiscard]] const MapperOptions& options() const { return options_; }
  /// In the order of the result's sub-maps.
  [[nodiscard]] const std::vector<RoundPart>& parts() const { return parts_; }
  /// As the build made it, with what was placed otherwise since.
  [[nodiscard]] const SubMap& submap_of(const RoundPart& part) const {
    return submaps_[part.submap];
  }
  /// The estimate with markers of a part put to other places (in its map's world), and the part
  /// adjusted again from there.
  [[nodiscard]] Estimate adjusted_from(const RoundPart& part,
                                       const std::map<MarkerId, Rigid3>& places) const;
  /// Makes that the round's own.
  void place(const RoundPart& part, const std::map<MarkerId, Rigid3>& places);
  /// nullopt: the round has seen no such marker.
  [[nodiscard]] std::optional<MarkerIndex> index_of(const MarkerId& id) const;
  [[nodiscard]] const Component& component_of(const RoundPart& part) const {
    return selection_.components()[part.component];
  }

 private:
  [[nodiscard]] std::vector<RoundPart> find_parts() const;
  [[nodiscard]] Estimate estimate_of_parts() const;

  const BuildResult& result_;
  MapperOptions options_;
  Selection selection_;
  std::vector<RoundPart> parts_;
  Estimate estimate_;
  PreparedObservations prepared_;
  std::vector<SubMap> submaps_;  ///< the result's
};

}  // namespace waymark
