#pragma once

#include "core/geometry/rigid3.h"
#include "mapbuilder/observations/observations.h"

namespace waymark {

/// A frame set with a pose.
struct LocalizedFrameSet {
  FrameSetIndex frame_set;
  Rigid3 world_from_rig;
};

}  // namespace waymark
