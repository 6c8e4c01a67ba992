#pragma once

#include <vector>

#include "mapbuilder/bundle/bundle_factor.h"

namespace waymark {

/// Values of all variables of a bundle problem, the constant ones among them beside. World frame:
/// the estimate's.
struct BundleVariables {
  std::vector<Rigid3> world_from_marker;  ///< per marker that takes part, the variable ones first
  std::vector<Rigid3> world_from_rig;     ///< per frame set that takes part
  IndexedVector<CameraIndex, RigCamera> cameras;
  IndexedVector<SizeClassIndex, double> size_factor;  ///< on top of the observations' sizes
  IndexedVector<CameraIndex, double> edge_bias_px;    ///< on top of the observations' corners
};

}  // namespace waymark
