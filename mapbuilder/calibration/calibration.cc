#include "mapbuilder/calibration/calibration.h"

#include <algorithm>

#include "core/base/check.h"
#include "core/camera/lens_kind.h"
#include "mapbuilder/bundle/survey_factors.h"
#include "mapbuilder/calibration/refinement_support.h"
#include "mapbuilder/calibration/rig_examination.h"
#include "mapbuilder/growth/adjustment_stages.h"

namespace waymark {
namespace {

/// A converged estimate and the system that it is one of.
struct Attempt {
  Estimate estimate;
  AdjustedSystem system;
  CalibrationUncertainty uncertainty;
  std::vector<std::string> left_as_stated;
  std::vector<std::string> refused;  ///< reasons; then the rest means nothing
};

class Calibrator {
 public:
  Calibrator(const IncrementalMapper& mapper, const CalibrationOptions& options, Progress& progress)
      : mapper_(mapper), options_(options), progress_(progress) {
    for (const ComponentIndex c : mapper.selection().components().indices()) all_.push_back(c);
  }

  /// All components as one system, nothing of the calibration variable.
  [[nodiscard]] AdjustedSystem plain_system() const { return {all_, {}}; }

  /// Adjusts with survey and `refine`; nullopt when the survey tells nothing and nothing is asked
  /// for.
  [[nodiscard]] std::optional<Attempt> attempt(const VariableCalibration& refine,
                                               Estimate estimate) const {
    if (options_.survey.empty() && !refine.any()) return std::nullopt;
    Attempt attempt{std::move(estimate), plain_system(), {}, {}, {}};
    attempt.system.scope.variable = refine;
    const bool surveyed = take_survey(attempt);
    if (!surveyed && !refine.any()) return std::nullopt;
    for (const Rig& rig : attempt.estimate.calibration.rigs) {
      for (const RigCamera& camera : rig.cameras) {
        attempt.system.scope.stated_cameras.push_back(camera);
      }
    }
    // A lens of many coefficients first as one of few, then by one more and one more: from afar
    // the further ones lead astray.
    const int most = refine.intrinsics ? most_coefficients(attempt.system.scope) : 0;
    for (int few = kFewCoefficients; few < most; ++few) {
      attempt.system.scope.variable.coefficients = few;
      adjust(attempt);
    }
    attempt.system.scope.variable.coefficients = refine.coefficients;
    adjust(attempt);
    // Judged at rest: a misfit rig passes for noise until it is refined.
    converge(attempt);
    if (refine.any()) leave_unsure_directions_as_stated(refine, attempt);
    return attempt;
  }

 private:
  static constexpr int kFewCoefficients = 4;

  static int most_coefficients(const BundleScope& scope) {
    int most = 0;
    for (const RigCamera& camera : scope.stated_cameras) {
      most = std::max(most, lens_kind(camera.model.parameters().distortion).count());
    }
    return most;
  }

  void adjust(Attempt& attempt) const {
    BundleSolution solution = mapper_.adjust(
        attempt.system, calibration_adjustment(mapper_.options()), std::move(attempt.estimate));
    attempt.estimate = std::move(solution.estimate);
    if (solution.uncertainty) attempt.uncertainty = std::move(*solution.uncertainty);
  }

  void converge(Attempt& attempt) const {
    ConvergedEstimate converged =
        mapper_.converge(attempt.system, std::move(attempt.estimate), progress_);
    attempt.estimate = std::move(converged.estimate);
    if (converged.uncertainty) attempt.uncertainty = std::move(*converged.uncertainty);
  }

  /// Lays the components that survey points fix into the facility's world; false where the survey
  /// tells nothing. Fills the scope's survey and worlds.
  [[nodiscard]] bool take_survey(Attempt& attempt) const {
    const Survey& survey = options_.survey;
    if (survey.empty()) return false;
    const Observations& observations = mapper_.selection().observations();
    Estimate& estimate = attempt.estimate;
    bool tells_scale = false;
    IndexedVector<MarkerIndex, WorldIndex> world_of_marker(observations.markers.size(),
                                                           WorldIndex(kFacilityWorld.value() + 1));
    for (const ComponentIndex c : all_) {
      const Component& component = mapper_.component(c);
      const MarkerPoses poses = poses_of(component, estimate);
      const SurveyReach reach = reach_of(survey, observations, estimate.calibration, poses);
      tells_scale = tells_scale || reach.scale;
      if (reach.frame) {
        const Rigid3 motion =
            *facility_from_world(survey, observations, estimate.calibration, poses);
        move_poses(component, motion, estimate);
      }
      const WorldIndex own(kFacilityWorld.value() + 1 + c.value());
      for (const MarkerIndex marker : component.markers) {
        world_of_marker[marker] = reach.frame ? kFacilityWorld : own;
      }
    }
    if (!tells_scale) return false;
    BundleScope& scope = attempt.system.scope;
    scope.survey = &survey;
    scope.world_of_marker = std::move(world_of_marker);
    // What the survey measures against the stated sizes is the printer's and the camera's doing.
    scope.variable.sizes = scope.variable.edge_bias = true;
    return true;
  }

  /// Finds what is less sure than the limits and leaves it as stated, until nothing is; fills
  /// `refused` with why that won't do.
  void leave_unsure_directions_as_stated(const VariableCalibration& asked, Attempt& attempt) const {
    const RefinementLimits& limits = options_.refinement_limits;
    // What is left as stated changes the noise, and that what is unsure: at the borders a second
    // round.
    constexpr int kMostRounds = 3;
    BundleScope& scope = attempt.system.scope;
    for (int round = 0;; ++round) {
      const std::vector<UnsureDirection> unsure =
          unsure_directions(attempt.uncertainty, scope.stated_cameras, limits);
      attempt.refused = reasons_against(asked, attempt.uncertainty, unsure,
                                        attempt.estimate.calibration.rigs, limits);
      if (!attempt.refused.empty() || unsure.empty()) return;
      if (round == kMostRounds) {
        attempt.refused = {unsure.back().text};
        return;
      }
      for (const UnsureDirection& one : unsure) {
        scope.constant_directions.push_back(one.direction);
        attempt.left_as_stated.push_back(one.text);
      }
      converge(attempt);
    }
  }

  const IncrementalMapper& mapper_;
  const CalibrationOptions& options_;
  Progress& progress_;
  std::vector<ComponentIndex> all_;
};

}  // namespace

CalibratedEstimate calibrate(const IncrementalMapper& mapper, const CalibrationOptions& options,
                             Estimate estimate, Progress& progress) {
  WAYMARK_CHECK(options.check().has_value());
  const Calibrator calibrator(mapper, options, progress);
  CalibratedEstimate result{{}, calibrator.plain_system(), {}};
  CalibrationResult& calibration = result.calibration;
  calibration.rigs_before = estimate.calibration.rigs;
  if (result.system.components.empty()) {
    result.estimate = std::move(estimate);
    return result;
  }
  std::optional<Attempt> attempt;
  if (options.refine.any()) {
    attempt = calibrator.attempt(options.refine, estimate);
    calibration.refined = attempt && attempt->refused.empty();
    if (attempt && !calibration.refined) calibration.refused = std::move(attempt->refused);
  }
  if (!calibration.refined) attempt = calibrator.attempt({}, estimate);
  if (attempt) {
    result.estimate = std::move(attempt->estimate);
    result.system = std::move(attempt->system);
    calibration.left_as_stated = std::move(attempt->left_as_stated);
  } else {
    result.estimate = std::move(estimate);
  }
  if (calibration.refined && (options.refine.extrinsics || options.refine.intrinsics)) {
    calibration.uncertainty = std::move(attempt->uncertainty);
    calibration.rigs_fitted = result.estimate.calibration.rigs;
  } else {
    examine_rig(mapper, result.system, result.estimate, calibration);
  }
  return result;
}

}  // namespace waymark
