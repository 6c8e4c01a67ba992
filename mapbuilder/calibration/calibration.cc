#include "mapbuilder/calibration/calibration.h"

#include <algorithm>

#include "mapbuilder/calibration/refinement_support.h"
#include "mapbuilder/growth/build_snapshot.h"

namespace waymark {
namespace {

/// Lays the parts that survey points fix into the facility's world; false where the survey tells
/// nothing. Fills the scope's survey and worlds.
bool take_survey(JointBuild& build, AdjustmentScope& scope) {
  const Survey& survey = build.options().survey;
  if (survey.empty()) return false;
  bool tells_scale = false;
  std::vector<int> world_of_marker(build.table().markers.size(), kFacilityWorld + 1);
  int world = kFacilityWorld;
  for (const ComponentGrowth* part : build.parts()) {
    ++world;
    const MarkerPoses poses = poses_of(part->component(), build.state());
    const SurveyReach reach = reach_of(survey, build.table(), poses);
    tells_scale = tells_scale || reach.scale;
    if (reach.frame) {
      move_poses(part->component(), *facility_from_world(survey, build.table(), poses),
                 build.state());
    }
    for (const int marker : part->component().markers) {
      world_of_marker[static_cast<std::size_t>(marker)] = reach.frame ? kFacilityWorld : world;
    }
  }
  if (!tells_scale) return false;
  scope.survey = &survey;
  scope.world_of_marker = std::move(world_of_marker);
  // What the survey measures against the stated sizes is the printer's and the camera's doing.
  scope.free.sizes = scope.free.edge_bias = true;
  return true;
}

/// Finds what is less sure than the limits and holds it, until nothing is; returns why that won't
/// do.
std::vector<std::string> hold_what_is_unsure(JointBuild& build, const FreeCalibration& asked,
                                             CalibrationResult& result) {
  const RefinementLimits& limits = build.options().refinement_limits;
  // What was held changes the noise, and that what is unsure: at the borders a second round.
  constexpr int kMostRounds = 3;
  for (int round = 0;; ++round) {
    const std::vector<UnsureDirection> unsure =
        unsure_directions(build.uncertainty(), build.scope().stated_cameras, limits);
    auto reasons = reasons_against(asked, build.uncertainty(), unsure, build.table().rigs, limits);
    if (!reasons.empty() || unsure.empty()) return reasons;
    if (round == kMostRounds) return {unsure.back().text};
    AdjustmentScope scope = build.scope();
    for (const UnsureDirection& direction : unsure) {
      scope.held_directions.push_back(direction.hold);
      result.held.push_back(direction.text);
    }
    build.set_scope(std::move(scope));
    build.settle();
  }
}

/// Adjusts with survey and `refine`. False when the survey tells nothing and nothing is asked for,
/// or the data can't support it: then all is as before, and result.refused says why.
bool attempt(JointBuild& build, const FreeCalibration& refine, CalibrationResult& result) {
  if (build.options().survey.empty() && !refine.any()) return false;
  BuildSnapshot before(build);
  AdjustmentScope scope;
  scope.free = refine;
  const bool surveyed = take_survey(build, scope);
  if (!surveyed && !refine.any()) return false;
  for (const Rig& rig : build.table().rigs) {
    scope.stated_cameras.insert(scope.stated_cameras.end(), rig.cameras.begin(), rig.cameras.end());
  }
  build.set_scope(std::move(scope));
  build.adjust({build.options().loss, 50, 1e-7, 1e-6, build.threads(), {}});
  // Judged once settled: a misfit rig passes for noise until it is refined.
  build.settle();
  if (!refine.any()) return true;
  auto reasons = hold_what_is_unsure(build, refine, result);
  if (reasons.empty()) return true;
  result.refused = std::move(reasons);
  result.held.clear();
  before.restore();
  return false;
}

ComponentFit fit_of(const ComponentGrowth& part, const MapState& state,
                    const std::vector<Rig>& rigs, double model_sigma_px) {
  ComponentFit fit{part.component(), {}, {}, {}, rigs, model_sigma_px};
  for (const int m : fit.component.markers) {
    fit.world_from_marker.push_back(state.world_from_marker[static_cast<std::size_t>(m)]);
  }
  for (const int f : fit.component.frame_sets) {
    const auto& rig = state.rigs[static_cast<std::size_t>(f)];
    fit.world_from_rig.push_back(rig && !rig->ambiguous ? std::optional(rig->best.pose)
                                                        : std::nullopt);
  }
  for (const std::size_t index : part.observations()) {
    if (state.accepted[index] == 0) fit.rejected.push_back(index);
  }
  return fit;
}

/// The fitted rig passed its own misfit for noise so far: noise and gate are judged anew.
std::vector<ComponentFit> settled_fits(const JointBuild& build, const AdjustmentOptions& options,
                                       ObservationTable& table, MapState& state) {
  std::vector<NoiseModel> noise;
  for (const ComponentGrowth* part : build.parts()) noise.push_back(part->noise());
  const auto judge = [&] {
    for (std::size_t i = 0; i < noise.size(); ++i) {
      build.parts()[i]->adapt_noise(table, state, noise[i]);
    }
    update_gate(table, build.observations(), build.options().gate, state);
  };
  judge();
  adjust_jointly(table, build.observations(), build.held(), options, state);
  judge();
  std::vector<ComponentFit> fits;
  for (std::size_t i = 0; i < noise.size(); ++i) {
    fits.push_back(fit_of(*build.parts()[i], state, table.rigs, noise[i].model_sigma_px));
  }
  return fits;
}

/// Whether the rig file fits the images: a few steps with all of it free, on copies. What they find
/// is evidence, the map stays as it is.
void examine_rig(const JointBuild& build, CalibrationResult& result) {
  ObservationTable table = build.table();
  MapState state = build.state();
  AdjustmentOptions options{build.options().loss, 4, 1e-2, 1e-6, build.threads(), build.scope()};
  const auto free_and_adjust = [&] {
    const AdjustmentSummary summary =
        adjust_jointly(table, build.observations(), build.held(), options, state);
    if (summary.uncertainty) result.uncertainty = *summary.uncertainty;
    return summary.initial_cost > 0 ? summary.final_cost / summary.initial_cost : 1.0;
  };
  const bool several_cameras = std::any_of(table.rigs.begin(), table.rigs.end(),
                                           [](const Rig& rig) { return rig.cameras.size() > 1; });
  if (several_cameras) {
    options.scope.free.extrinsics = true;
    result.extrinsics_cost_ratio = free_and_adjust();
  }
  // Extrinsics first: what they explain is not the lens's fault.
  const std::vector<Rig> with_extrinsics = table.rigs;
  const CalibrationUncertainty of_extrinsics = result.uncertainty;
  options.scope.free.intrinsics = true;
  result.intrinsics_cost_ratio = free_and_adjust();
  result.rigs_fitted = table.rigs;
  if (result.intrinsics_cost_ratio > kExplainsTooLittle && several_cameras) {
    result.rigs_fitted = with_extrinsics;
    result.uncertainty = of_extrinsics;
  }
  if (std::min(result.extrinsics_cost_ratio, result.intrinsics_cost_ratio) < kExplainsTooLittle) {
    result.fits = settled_fits(build, options, table, state);
  }
}

}  // namespace

CalibrationResult calibrate(JointBuild& build) {
  CalibrationResult result;
  result.rigs_before = build.table().rigs;
  const FreeCalibration& refine = build.options().refine;
  result.refined = refine.any() && attempt(build, refine, result);
  if (!result.refined) attempt(build, {}, result);
  if (result.refined && (refine.extrinsics || refine.intrinsics)) {
    result.uncertainty = build.uncertainty();
    result.rigs_fitted = build.table().rigs;
  } else {
    examine_rig(build, result);
  }
  if (result.fits.empty()) {
    for (const ComponentGrowth* part : build.parts()) {
      result.fits.push_back(
          fit_of(*part, build.state(), build.table().rigs, part->noise().model_sigma_px));
    }
  }
  return result;
}

}  // namespace waymark
