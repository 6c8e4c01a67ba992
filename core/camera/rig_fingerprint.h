#pragma once

#include <string>

#include "core/camera/rig.h"

namespace waymark {

/// 16 hexadecimal digits that depend on a rig's numbers and nothing else: places and lenses of its
/// cameras as they are used, to the last bit; sigmas, names and serials apart.
[[nodiscard]] std::string fingerprint(const Rig& rig);

}  // namespace waymark
