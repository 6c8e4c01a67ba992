#pragma once

#include "core/geometry/rigid3.h"

namespace waymark {

/// A frame set with a pose.
struct LocalizedFrameSet {
  int frame_set = 0;  ///< index in the table
  Rigid3 world_from_rig;
};

}  // namespace waymark
