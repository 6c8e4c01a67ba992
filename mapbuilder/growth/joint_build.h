#pragma once

#include <vector>

#include "core/base/progress.h"
#include "mapbuilder/growth/component_growth.h"

namespace waymark {

/// Grown components that are adjusted as one system: alone each, or all of them when they share a
/// calibration or a survey. Everything it is given must outlive it.
class JointBuild {
 public:
  JointBuild(ObservationTable& table, std::vector<ComponentGrowth*> parts,
             const BuildOptions& options, Progress& progress, MapState& state);

  /// What the next adjustments free and rest on. Anchors are held but in the facility's world.
  void set_scope(AdjustmentScope scope);

  /// Adjusts, reconsiders flips and gates until nothing changes any more.
  void settle();
  AdjustmentSummary adjust(const AdjustmentOptions& options);

  [[nodiscard]] const AdjustmentScope& scope() const { return scope_; }
  [[nodiscard]] const HeldPoses& held() const { return held_; }
  [[nodiscard]] const std::vector<ComponentGrowth*>& parts() const { return parts_; }
  [[nodiscard]] const std::vector<std::size_t>& observations() const { return observations_; }
  /// Of the last adjustment that freed a calibration.
  [[nodiscard]] const CalibrationUncertainty& uncertainty() const { return uncertainty_; }
  [[nodiscard]] ObservationTable& table() const { return table_; }
  [[nodiscard]] MapState& state() const { return state_; }
  [[nodiscard]] int threads() const { return threads_; }
  [[nodiscard]] const BuildOptions& options() const { return options_; }

 private:
  double adapt_noise();

  ObservationTable& table_;
  std::vector<ComponentGrowth*> parts_;
  const BuildOptions& options_;
  Progress& progress_;
  MapState& state_;
  int threads_;
  std::vector<std::size_t> observations_;
  HeldPoses held_;
  AdjustmentScope scope_;
  CalibrationUncertainty uncertainty_;
};

}  // namespace waymark
