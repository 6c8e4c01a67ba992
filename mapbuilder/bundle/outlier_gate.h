#pragma once

#include <span>

#include "core/base/range.h"
#include "mapbuilder/bundle/prepared_observations.h"

namespace waymark {

/// Options of the hard gate.
struct OutlierGateOptions {
  bool enabled = true;
  /// Sigmas. An observation is rejected when its eight residuals together exceed this.
  /// Gaussian noise stays below 8 sigmas; the tails of real corners (motion blur, occlusion) reach
  /// 15–20 on the aviary and still tell where the rig is, while a wrong id is hundreds off. It
  /// comes back below 0.9 of it; the hysteresis keeps one at the border from toggling.
  double reject_sigmas = 20.0;

  static constexpr Range kRejectSigmas{3, 100};
  /// usage, naming the field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// What the gate makes of an estimate.
struct GatedEstimate {
  Estimate estimate;
  std::size_t changed = 0;  ///< observations that were rejected or re-admitted
};

/// Judges each of the observations against the estimate's poses: rejects those beyond the gate,
/// re-admits those that fit again (the poses may have been wrong before). Observations without both
/// ends posed stay as they are.
[[nodiscard]] GatedEstimate gate_outliers(const PreparedObservations& prepared,
                                          std::span<const ObservationIndex> observations,
                                          const OutlierGateOptions& options, Estimate estimate);

}  // namespace waymark
