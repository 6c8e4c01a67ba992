#pragma once

#include <cstdint>
#include <string>

#include "core/base/error.h"
#include "core/camera/rig.h"

namespace waymark {

/// All of a rig's images together are no larger: what works on them reserves memory by their
/// pixels.
inline constexpr std::int64_t kMaxRigPixels = 200'000'000;

/// bad_data, naming `name`, for a rig whose images are larger.
[[nodiscard]] Status check_image_sizes(const Rig& rig, const std::string& name);

}  // namespace waymark
