#pragma once

#include <string>

#include "core/camera/rig.h"

namespace waymark {

/// 16 hexadecimal digits that depend on a rig's numbers and nothing else: places and lenses of its
/// cameras as they are used, places to 1e-9 (m, and of rotations' matrices): a file that is written
/// and read again has them so; sigmas, names and serials apart.
[[nodiscard]] std::string fingerprint(const Rig& rig);

}  // namespace waymark
