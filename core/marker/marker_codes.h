#pragma once

#include <cstdint>

#include "core/marker/marker_id.h"

namespace waymark {

/// The marker's code: bit i is set where cell i of its layout (MarkerLayout::code) is white. The
/// id's number must lie within its family (checked).
///
/// The tables are part of the library: core/marker/codes/ has a file per family, ids in order, each
/// in as many bytes as its bits need, the lowest first. They were made once of OpenCV's and
/// libapriltag's pictures, and aruco_mip_36h12 of its authors' table; a test holds them against
/// both libraries.
[[nodiscard]] std::uint64_t marker_code(const MarkerId& id);

}  // namespace waymark
