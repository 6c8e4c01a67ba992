#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/cause.h"
#include "mapbuilder/diagnosis/rig_agreement.h"

namespace waymark {

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
  Extrinsics rig_from_cam;
  bool turns_lenses = false;  ///< the driver turns images of `cameras`, principal points with them
  bool exchanges_lenses = false;  ///< both `cameras`' images carry the other's name, their lens too
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
  double gain = 0;  ///< 2 Δ ln L over the rig as stated, sigmas², less the price of its numbers
};

}  // namespace waymark
