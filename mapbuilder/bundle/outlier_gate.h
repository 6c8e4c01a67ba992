#pragma once

#include <span>

#include "mapbuilder/bundle/map_state.h"

namespace waymark {

/// Options of the hard gate.
struct GateOptions {
  bool enabled = true;
  /// (3–100 sigmas) An observation is rejected when its eight residuals together exceed this.
  /// Gaussian noise stays below 8 sigmas; the tails of real corners (motion blur, occlusion) reach
  /// 15–20 on the aviary and still tell where the rig is, while a wrong id is hundreds off. It
  /// comes back below 0.9 of it; the hysteresis keeps one at the border from toggling.
  double reject_sigmas = 20.0;
};

/// Judges each of the observations against the present poses: rejects those beyond the gate,
/// re-admits those that fit again (the poses may have been wrong before). Observations without both
/// ends posed stay as they are. Returns how many changed.
std::size_t update_gate(const ObservationTable& table, std::span<const std::size_t> observations,
                        const GateOptions& options, MapState& state);

}  // namespace waymark
