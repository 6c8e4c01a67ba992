#pragma once

#include <string>

#include "locd/pose/pose_estimate.h"

namespace waymark {

/// What a pose is worth in words, into `text`: "OK, 14 markers, 3 mm"; "DEGRADED: cam1 missing";
/// "LOST: no mapped marker seen". Every reason that holds, in the order of their bits. Allocates
/// nothing while `text` has room for kMostStatusText bytes.
void write_status_text(const PoseEstimate& estimate, std::string& text);

/// More than any status needs.
inline constexpr std::size_t kMostStatusText = 640;

}  // namespace waymark
