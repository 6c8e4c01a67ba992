#pragma once

#include <iosfwd>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/frame_source.h"

namespace waymark {

/// Opens each camera, lets it run until a frame comes, and prints what it is and what it does. One
/// that `owner`, the process of a running locd, has open is left alone. All are looked at; the
/// error is that of the first that fails.
[[nodiscard]] Status check_cameras(const std::vector<std::unique_ptr<FrameSource>>& cameras,
                                   std::optional<int> owner, std::ostream& out);

}  // namespace waymark
