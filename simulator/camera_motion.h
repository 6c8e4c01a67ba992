#pragma once

#include <functional>

#include "core/geometry/rigid3.h"

namespace waymark::simulator {

/// world_from_cam as a function of time (s) since the middle of the exposure of the image's middle
/// row.
using CameraMotion = std::function<Rigid3(double)>;

}  // namespace waymark::simulator
