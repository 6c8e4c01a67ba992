#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "mapbuilder/bundle/bundle_adjustment.h"
#include "mapbuilder/growth/mapper_options.h"
#include "mapbuilder/growth/placement_queue.h"

namespace waymark {

/// What is adjusted as one system: a component, or several that share a calibration or a survey.
struct AdjustedSystem {
  std::vector<ComponentIndex> components;
  BundleScope scope;
};

/// What reconsidering flips makes of an estimate.
struct ReconsideredEstimate {
  Estimate estimate;
  std::size_t moved = 0;  ///< frame sets and markers
};

/// What fitting the noise model makes of an estimate.
struct NoiseFittedEstimate {
  Estimate estimate;
  double change = 0;  ///< relative, of the component's sigma
};

/// An estimate at rest, or as near to it as the passes led: see ComponentEstimate::converged.
struct ConvergedEstimate {
  Estimate estimate;
  std::optional<CalibrationUncertainty> uncertainty;  ///< of the last adjustment that had a say
};

/// Algorithm 2: how a map begins and grows. Each step is a function from estimate to estimate,
/// so neither order nor threads leave a trace, and a copy is the way back. One thread calls.
class IncrementalMapper {
 public:
  /// The selection must outlive it.
  IncrementalMapper(const Selection& selection, const MapperOptions& options);

  [[nodiscard]] const Selection& selection() const { return selection_; }
  [[nodiscard]] const MapperOptions& options() const { return options_; }
  [[nodiscard]] const Component& component(ComponentIndex index) const {
    return selection_.components()[index];
  }
  /// The frame set that a component grows from, and the observations of the component.
  [[nodiscard]] FrameSetIndex seed_of(ComponentIndex index) const { return parts_[index].seed; }
  [[nodiscard]] std::vector<ObservationIndex> observations_of(
      std::span<const ComponentIndex> components) const;

  /// The observations as the estimate has them; good until the next step of this mapper.
  [[nodiscard]] const PreparedObservations& prepared(
      const Estimate& estimate,
      PreparedObservations::Ippe ippe = PreparedObservations::Ippe::solved) const;

  /// The whole of it for one component: seeds, unless the seed has a pose already and growth goes
  /// on from what is posed; then in rounds localizes every frame set that sees the map (Algorithm
  /// 1), places every marker that localized frame sets see, and adjusts as the map grows, until
  /// nothing is left that can be placed or localized. A pose that is still ambiguous is kept with
  /// its runner-up until evidence decides. Ends early once gives_up().
  [[nodiscard]] Estimate grow(ComponentIndex component, Estimate estimate,
                              Progress& progress) const;

  /// Whether a component that has grown to ten markers and more misses by so much that growth ends
  /// (GrowthOptions::give_up_sigma_px).
  [[nodiscard]] bool gives_up(ComponentIndex component, const Estimate& estimate) const;

  /// The frame of the component's seed is its world.
  [[nodiscard]] Estimate seed(ComponentIndex component, Estimate estimate) const;

  /// The given frame sets anew, by Algorithm 1.
  [[nodiscard]] Estimate localize(std::span<const FrameSetIndex> frame_sets,
                                  Estimate estimate) const;

  /// Puts markers where they are said to be, localizes the frame sets that see them, and adjusts
  /// both against the rest: what is placed next rests on them.
  [[nodiscard]] Estimate place(ComponentIndex component, std::span<const PlacedMarker> markers,
                               Estimate estimate) const;

  /// Equation 11 over the system; the frame sets that it leaves out are localized afterwards. Each
  /// component's seed is constant but in the facility's world.
  [[nodiscard]] BundleSolution adjust(const AdjustedSystem& system, const BundleOptions& options,
                                      Estimate estimate) const;

  /// A flip chosen early is reconsidered: every localized frame set and every placed marker of the
  /// component is solved afresh from all its IPPE solutions on its accepted observations; the best
  /// takes the place of what was known (a marker only when it scores better by more than 1 sigma²
  /// over all its views).
  [[nodiscard]] ReconsideredEstimate reconsider(ComponentIndex component, Estimate estimate) const;

  /// Estimates the component's noise model from its residuals.
  [[nodiscard]] NoiseFittedEstimate fit_noise(ComponentIndex component, Estimate estimate) const;

  /// Judges the components' observations by the outlier gate.
  [[nodiscard]] GatedEstimate gate(std::span<const ComponentIndex> components,
                                   Estimate estimate) const;

  /// Adjusts, reconsiders flips and gates until nothing changes any more.
  [[nodiscard]] ConvergedEstimate converge(const AdjustedSystem& system, Estimate estimate,
                                           Progress& progress) const;

 private:
  /// What a component has beside its frame sets and markers.
  struct Part {
    FrameSetIndex seed;
    std::vector<ObservationIndex> observations;
  };

  [[nodiscard]] Estimate adjust_growing(ComponentIndex component, Estimate estimate) const;
  [[nodiscard]] Estimate adjust_fresh(ComponentIndex component,
                                      std::span<const PlacedMarker> markers,
                                      Estimate estimate) const;
  [[nodiscard]] ReconsideredEstimate reconsider_frame_sets(const Component& component,
                                                           Estimate estimate) const;
  [[nodiscard]] ReconsideredEstimate reconsider_markers(const Component& component,
                                                        Estimate estimate) const;
  [[nodiscard]] bool differ(const Rigid3& a, const Rigid3& b) const;
  [[nodiscard]] std::vector<FrameSetIndex> frame_sets_that_see(
      std::span<const MarkerIndex> markers) const;

  const Selection& selection_;
  MapperOptions options_;
  IndexedVector<ComponentIndex, Part> parts_;
  mutable std::optional<PreparedObservations> prepared_;  ///< a cache, see prepared()
};

}  // namespace waymark
