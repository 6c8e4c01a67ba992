#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/observations/covisibility.h"

namespace waymark {

/// What explains the images of one component of the table's graph best: the map's own cameras and
/// poses or, where the rig file does not fit, those of a rig that was free for a few steps. The map
/// does not use the latter; single detections are judged by it. World frame: any.
struct ComponentFit {
  Component component;
  std::vector<std::optional<Rigid3>> world_from_marker;  ///< per marker of the component
  std::vector<std::optional<Rigid3>> world_from_rig;     ///< per frame set; unambiguous ones only
  std::vector<std::size_t> rejected;                     ///< by the gate; table indices, rising
  std::vector<Rig> rigs;                                 ///< of the table
  double model_sigma_px = 0;
};

}  // namespace waymark
