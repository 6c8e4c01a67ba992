#pragma once

#include <optional>
#include <string_view>

namespace waymark {

/// Who found a camera's numbers: tells how far off they may be where the rig file does not.
enum class SigmaSource { kalibr, opencv, hand, refined };

/// "kalibr", "opencv", "hand", "refined", as rig.yaml writes them.
[[nodiscard]] std::string_view to_string(SigmaSource source);

/// nullopt for an unknown name.
[[nodiscard]] std::optional<SigmaSource> sigma_source_from(std::string_view name);

/// One standard deviation each of what a rig file states of a camera (true less stated). Such
/// errors are the same in every image, so that no number of images averages them out.
template <typename T>
struct SigmasOf {
  T position_m{};    ///< of rig_from_cam, per axis of the rig
  T rotation_rad{};  ///< of rig_from_cam, about each axis of the rig
  T focal{};         ///< of fu and fv alike, as a share of them
  T principal_px{};  ///< of the principal point, per axis
  T k1{};            ///< of the lens's first coefficient
  T edge_px{};       ///< of the edges' places, all outward alike (outward_of)
  T stamp_s{};       ///< of the offset of its stamps
  T readout_s{};     ///< of the read-out time of the whole image

  bool operator==(const SigmasOf&) const = default;
};

/// As a rig file states them: any subset.
using StatedSigmas = SigmasOf<std::optional<double>>;

/// All of them; 0 where nothing can be wrong.
using CameraSigmas = SigmasOf<double>;

/// What tells how large sigmas are beside the rig file.
struct SigmaCircumstances {
  bool triggered = false;  ///< one hardware trigger exposes all cameras
};

/// The documented defaults (docs/conventions.md) of a camera whose calibration is of `source` and
/// whose read-out time is stated (s), known to be none (0: global shutter) or not stated
/// (nullopt). A refined calibration states its sigmas itself; where it does not, it counts as
/// Kalibr's.
[[nodiscard]] CameraSigmas default_sigmas(SigmaSource source, std::optional<double> readout_s,
                                          const SigmaCircumstances& circumstances);

}  // namespace waymark
