#include "mapbuilder/diagnosis/explained_build.h"

#include <algorithm>
#include <utility>

#include "mapbuilder/diagnosis/capture_causes.h"
#include "mapbuilder/diagnosis/fit_quality.h"

namespace waymark {
namespace {

/// Whether something that all observations share is wrong.
bool is_contradicted(const Selection& selection, const BuildResult& plain) {
  const CalibrationResult& calibration = plain.calibration;
  const FitQuality quality = fit_quality(selection, plain);
  return calibration.extrinsics_cost_ratio < kExplainsTooLittle ||
         calibration.intrinsics_cost_ratio < kExplainsTooLittle || quality.contradicts() ||
         quality.joint_px > kPoorFit_px;
}

/// Whether the explanation is more than a camera that stands elsewhere.
bool explains(const ExplainedCaptures& explained) {
  return !explained.findings.empty() &&
         std::none_of(explained.findings.begin(), explained.findings.end(),
                      [](const Finding& finding) { return finding.cause == Cause::rig_displaced; });
}

}  // namespace

Expected<ExplainedBuild> build_explained(const std::vector<DetectedCapture>& captures,
                                         Observations observations,
                                         const ObservationOptions& observing,
                                         const BuildOptions& options, Progress& progress) {
  ExplainedBuild build;
  build.observations = std::move(observations);
  // Judged as stated: a refinement would bend rig and lens to whatever else is wrong.
  BuildOptions as_stated = options;
  as_stated.refine = {};
  const Selection selection(build.observations);
  std::optional<BuildResult> plain = build_map(selection, as_stated, progress);
  if (is_contradicted(selection, *plain)) {
    ExplainedCaptures explained =
        explain_captures(captures, fit_quality(selection, *plain).joint_px, as_stated, progress);
    if (explains(explained)) {
      auto put_right = make_observations(explained.captures, observing);
      if (!put_right) return tl::make_unexpected(put_right.error());
      build.observations = *std::move(put_right);
      build.causes = std::move(explained.findings);
      plain.reset();
    }
  }
  if (options.refine.any()) plain.reset();
  build.diagnosed = build_and_diagnose(build.observations, options, {}, progress, std::move(plain));
  return build;
}

}  // namespace waymark
