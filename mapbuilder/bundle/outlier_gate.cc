#include "mapbuilder/bundle/outlier_gate.h"

#include "core/base/range.h"

namespace waymark {

Status OutlierGateOptions::check() const {
  return RangeCheck().field("reject_sigmas", reject_sigmas, kRejectSigmas).status();
}

GatedEstimate gate_outliers(const PreparedObservations& prepared,
                            std::span<const ObservationIndex> observations,
                            const OutlierGateOptions& options, Estimate estimate) {
  GatedEstimate gated{std::move(estimate), 0};
  if (!options.enabled) return gated;
  constexpr double kReadmission = 0.9;
  const double reject = options.reject_sigmas * options.reject_sigmas;
  const double readmit = kReadmission * kReadmission * reject;
  const Observations& all = prepared.observations();
  for (const ObservationIndex index : observations) {
    const Observation& o = all[index];
    if (!gated.estimate.posed(o)) continue;
    const double s =
        squared_residual(prepared[index], gated.estimate.calibration.camera(all, o).model,
                         cam_from_marker(all, gated.estimate, o));
    char& accepted = gated.estimate.accepted[index];
    const char verdict = s > reject ? 0 : (s < readmit ? 1 : accepted);
    gated.changed += verdict != accepted ? 1 : 0;
    accepted = verdict;
  }
  return gated;
}

}  // namespace waymark
