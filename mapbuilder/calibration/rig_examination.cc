#include "mapbuilder/calibration/rig_examination.h"

#include <algorithm>

#include "mapbuilder/growth/adjustment_stages.h"

namespace waymark {
namespace {

/// The mapper's adjustment without what it does to frame sets that take no part.
class Trial {
 public:
  Trial(const IncrementalMapper& mapper, const AdjustedSystem& system, const Estimate& estimate)
      : mapper_(mapper), components_(system.components), estimate_(estimate) {
    problem_.scope = system.scope;
    problem_.loss = mapper.options().loss;
    problem_.observations = mapper.observations_of(components_);
    for (const ComponentIndex c : components_) {
      if (!system.scope.in_facility(mapper.component(c).markers.front())) {
        problem_.constant.frame_sets.push_back(mapper.seed_of(c));
      }
    }
  }

  [[nodiscard]] VariableCalibration& variable() { return problem_.scope.variable; }
  [[nodiscard]] const Estimate& estimate() const { return estimate_; }
  [[nodiscard]] Estimate take() && { return std::move(estimate_); }

  /// Adjusts; the cost afterwards as a share of that before.
  double adjust(std::optional<CalibrationUncertainty>& uncertainty) {
    problem_.prepared = &mapper_.prepared(estimate_, PreparedObservations::Ippe::none);
    // A few steps tell: whether it has converged does not matter.
    BundleSolution solution =
        waymark::adjust(problem_, trial_adjustment(mapper_.options()), std::move(estimate_));
    estimate_ = std::move(solution.estimate);
    uncertainty = std::move(solution.uncertainty);
    const BundleSummary& summary = solution.summary;
    return summary.initial_cost > 0 ? summary.final_cost / summary.initial_cost : 1.0;
  }

  /// Judges noise and gate anew.
  void judge() {
    for (const ComponentIndex c : components_) {
      estimate_ = mapper_.fit_noise(c, std::move(estimate_)).estimate;
    }
    estimate_ = mapper_.gate(components_, std::move(estimate_)).estimate;
  }

 private:
  const IncrementalMapper& mapper_;
  std::vector<ComponentIndex> components_;
  Estimate estimate_;
  BundleProblem problem_;
};

}  // namespace

void examine_rig(const IncrementalMapper& mapper, const AdjustedSystem& system,
                 const Estimate& estimate, CalibrationResult& result) {
  const auto& rigs = estimate.calibration.rigs;
  const bool several_cameras =
      std::any_of(rigs.begin(), rigs.end(), [](const Rig& rig) { return rig.cameras.size() > 1; });
  Trial trial(mapper, system, estimate);
  std::optional<CalibrationUncertainty> of_extrinsics;
  if (several_cameras) {
    trial.variable().extrinsics = true;
    result.extrinsics_cost_ratio = trial.adjust(of_extrinsics);
  }
  // Extrinsics first: what they explain is not the lens's fault.
  const IndexedVector<RigIndex, Rig> with_extrinsics = trial.estimate().calibration.rigs;
  std::optional<CalibrationUncertainty> of_all;
  trial.variable().intrinsics = true;
  result.intrinsics_cost_ratio = trial.adjust(of_all);
  const bool by_extrinsics = result.intrinsics_cost_ratio > kExplainsTooLittle && several_cameras;
  result.rigs_fitted = by_extrinsics ? with_extrinsics : trial.estimate().calibration.rigs;
  const auto& uncertainty = by_extrinsics ? of_extrinsics : of_all;
  if (uncertainty) result.uncertainty = *uncertainty;
  if (std::min(result.extrinsics_cost_ratio, result.intrinsics_cost_ratio) < kExplainsTooLittle) {
    // The fitted rig passed its own misfit for noise so far.
    trial.judge();
    std::optional<CalibrationUncertainty> ignored;
    (void)trial.adjust(ignored);
    trial.judge();
    result.examined = std::move(trial).take();
  }
}

}  // namespace waymark
