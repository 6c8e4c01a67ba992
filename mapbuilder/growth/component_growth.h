#pragma once

#include <vector>

#include "core/base/progress.h"
#include "mapbuilder/bundle/joint_adjustment.h"
#include "mapbuilder/growth/build_options.h"

namespace waymark {

/// One component of the table's graph on its way from observations to poses. Its anchor, the frame
/// set it grows from, is its world until somebody moves it. Table and component must outlive it.
class ComponentGrowth {
 public:
  ComponentGrowth(ObservationTable& table, const Component& component, const BuildOptions& options);
  ComponentGrowth(const ComponentGrowth&) = delete;
  ComponentGrowth& operator=(const ComponentGrowth&) = delete;

  /// Algorithm 2, with joint adjustments on the way.
  void grow(MapState& state, Progress& progress);

  /// A joint adjustment leaves out the frame sets with one accepted marker; they follow.
  void follow(MapState& state) const { growth_.localize_unadjusted(state); }
  /// Flips chosen early; returns how many moved. See Growth::reconsider.
  std::size_t reconsider(MapState& state) const { return growth_.reconsider(state); }

  /// Re-estimates `noise` and the whitening of the component's observations in `table`; returns its
  /// relative change.
  double adapt_noise(ObservationTable& table, const MapState& state, NoiseModel& noise) const;
  double adapt_noise(const MapState& state) { return adapt_noise(table_, state, noise_); }

  [[nodiscard]] const Component& component() const { return component_; }
  [[nodiscard]] const std::vector<std::size_t>& observations() const { return observations_; }
  [[nodiscard]] int anchor() const { return anchor_; }
  [[nodiscard]] const NoiseModel& noise() const { return noise_; }
  void set_noise(const NoiseModel& noise) { noise_ = noise; }
  /// Whether the last adjustment converged with gate, flips and noise at rest.
  [[nodiscard]] bool settled() const { return settled_; }
  void set_settled(bool settled) { settled_ = settled; }

 private:
  void adjust(MapState& state) const;
  /// Adjusts markers that were just placed, with the frame sets that see them, against the rest:
  /// what is placed next rests on them.
  void adjust_fresh(const std::vector<int>& markers, MapState& state) const;

  ObservationTable& table_;
  const Component& component_;
  ObservationLoss loss_;
  int threads_;
  NoiseModel noise_;
  Growth growth_;
  std::vector<std::size_t> observations_;
  int anchor_;
  bool settled_ = false;
};

}  // namespace waymark
