#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/cause.h"
#include "core/camera/rig.h"
#include "mapbuilder/diagnosis/camera_tracks.h"

namespace waymark {

/// How well a rig file is known that is right, one standard deviation per axis of rig_from_cam:
/// twice what a calibration with a target leaves (1 mm, 0.05°). A hypothesis need not explain less.
struct ExtrinsicSigmas {
  double position_m = 0.002;       ///< (1e-5–0.1)
  double rotation_rad = 0.001745;  ///< (1e-5–0.1) 0.1°

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Why cameras that fit alone do not fit together.
struct RigExplanation {
  Cause cause = Cause::rig_displaced;
  std::vector<std::size_t> cameras;  ///< concerned, rising
  /// The fitted number with its standard deviation and unit: a clock's offset (ms, positive: its
  /// images are older than stamped), a turn (°), a scale (stated sizes over those that fit the
  /// baselines), a distance (m); 0 where nothing is fitted.
  double value = 0;
  double sigma = 0;
  std::string unit;
  std::optional<Stamp> since;  ///< of the first frame set that it holds for; nullopt: all
  std::string detail;          ///< plain words after the subject
  std::string remedy;
  /// The rig that explains the cameras; where time is the cause, that stated.
  std::vector<Rigid3> rig_from_cam;
  /// Observations of `cameras` from `since` on fit no rigid rig and are left out of the map.
  bool leave_out = false;
  /// Another cause that explains the cameras as well, for the rig is its own mirror image; empty
  /// detail: none.
  struct Alternative {
    Cause cause = Cause::rig_displaced;
    std::vector<std::size_t> cameras;
    std::string detail;
    std::string remedy;
  } alternative;
  /// The alternative as an explanation of its own.
  [[nodiscard]] RigExplanation or_else() const;
  double gain = 0;  ///< 2 Δ ln L over the rig as stated, sigmas², less the price of its numbers
};

/// Holds the stated rig against where its cameras stood, and names the simplest cause of what does
/// not fit: chain or link inverted, two exchanged, turned by a quarter or half, wrong unit, sizes
/// against baselines, clock, frames out of step, bumped on the way, displaced. nullopt when the
/// stated rig explains the tracks as well as any, or when no cause stands clearly above the others.
///
/// Every hypothesis predicts rig_from_cam of each camera and instant; the rig's pose is what most
/// cameras of the instant agree on; misfits count bounded (Welsch's loss at 6 sigmas), scaled by
/// the noise that the best hypothesis leaves. A hypothesis is priced by ln n per number that it
/// frees; each may use what `stated` leaves open of the calibration.
[[nodiscard]] std::optional<RigExplanation> explain_rig(const CameraTracks& tracks,
                                                        const Rig& stated,
                                                        const ExtrinsicSigmas& sigmas = {});

}  // namespace waymark
