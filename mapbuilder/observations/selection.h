#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "mapbuilder/observations/observations.h"

namespace waymark {

using ComponentIndex = Index<struct ComponentKind>;

/// What has been found wrong with observations, so that it can't harm the rest of a map.
struct Corrections {
  std::set<ObservationIndex> left_out;
  std::map<MarkerIndex, double> sizes_m;  ///< in place of the stated ones
};

/// Frame sets and markers that hang together by observations; all indices rising.
struct Component {
  std::vector<FrameSetIndex> frame_sets;
  std::vector<MarkerIndex> markers;
};

/// The observations that a map is built on, as lists of indices into all of them, with the sizes
/// that count as stated and the connected components of the graph frame sets – markers. The
/// observations must outlive it.
class Selection {
 public:
  explicit Selection(const Observations& observations, const Corrections& corrections = {});

  [[nodiscard]] const Observations& observations() const { return *observations_; }
  [[nodiscard]] const Observation& operator[](ObservationIndex index) const {
    return (*observations_)[index];
  }
  [[nodiscard]] const Corrections& corrections() const { return corrections_; }

  /// Rising.
  [[nodiscard]] std::span<const ObservationIndex> used() const { return used_; }
  [[nodiscard]] std::span<const ObservationIndex> used_in(FrameSetIndex frame_set) const;
  [[nodiscard]] std::span<const ObservationIndex> used_of(MarkerIndex marker) const {
    return used_of_[marker];
  }
  /// Those of all given frame sets.
  [[nodiscard]] std::vector<ObservationIndex> used_in(
      std::span<const FrameSetIndex> frame_sets) const;

  /// The others, which no map is built on but a finished one may judge: those of an id found twice
  /// in one image, then those left out; each rising.
  [[nodiscard]] std::span<const ObservationIndex> unused() const { return unused_; }

  /// By markers.toml, or the correction's.
  [[nodiscard]] const IndexedVector<MarkerIndex, double>& stated_sizes_m() const {
    return stated_sizes_m_;
  }

  /// By falling marker count, then first marker.
  [[nodiscard]] const IndexedVector<ComponentIndex, Component>& components() const {
    return components_;
  }
  /// nullopt: the frame set has no used observation.
  [[nodiscard]] std::optional<ComponentIndex> component_of(FrameSetIndex frame_set) const {
    return component_of_[frame_set];
  }

 private:
  const Observations* observations_;
  Corrections corrections_;
  std::vector<ObservationIndex> used_;
  IndexedVector<FrameSetIndex, std::size_t> first_in_;  ///< in used_, and the end
  IndexedVector<MarkerIndex, std::vector<ObservationIndex>> used_of_;
  std::vector<ObservationIndex> unused_;
  IndexedVector<MarkerIndex, double> stated_sizes_m_;
  IndexedVector<ComponentIndex, Component> components_;
  IndexedVector<FrameSetIndex, std::optional<ComponentIndex>> component_of_;
};

}  // namespace waymark
