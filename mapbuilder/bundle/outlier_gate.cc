#include "mapbuilder/bundle/outlier_gate.h"

namespace waymark {

std::size_t update_gate(const ObservationTable& table, std::span<const std::size_t> observations,
                        const GateOptions& options, MapState& state) {
  if (!options.enabled) return 0;
  constexpr double kReadmission = 0.9;
  const double reject = options.reject_sigmas * options.reject_sigmas;
  const double readmit = kReadmission * kReadmission * reject;
  std::size_t changed = 0;
  for (const std::size_t index : observations) {
    const TableObservation& o = table.observations[index];
    if (!state.posed(o)) continue;
    const double s =
        squared_residual(o, camera_of(table, o).model, cam_from_marker(table, state, o));
    char& accepted = state.accepted[index];
    const char verdict = s > reject ? 0 : (s < readmit ? 1 : accepted);
    changed += verdict != accepted ? 1 : 0;
    accepted = verdict;
  }
  return changed;
}

}  // namespace waymark
