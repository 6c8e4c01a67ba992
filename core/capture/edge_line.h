#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/camera/edge_measurement.h"

namespace waymark {

/// By how much a camera's corners were moved outward.
struct EdgeMove {
  /// Of every marker alike, as rig.yaml stated it or not at all (0); of measured ones the mean.
  double px = 0;
  std::optional<EdgeMeasurement> measured{};  ///< where its own images told it, marker by marker
};

inline constexpr std::string_view kEdgeLinePrefix = "# edges camera=";

/// What a detections.csv says of one camera's corners: moved as was measured,
/// `# edges camera=cam0 bias_px=0.2680 sigma_px=0.009 response=srgb` (linear, srgb, open), or as
/// stated, `# edges camera=cam0 moved_px=0.25` (0: not moved).
[[nodiscard]] std::string edge_line(std::string_view camera, const EdgeMove& move);

/// Such a line, taken apart.
struct EdgeLine {
  std::string camera;
  EdgeMove move;
};

/// nullopt where the line is none, or a number is none, is not finite, or is a sigma that is not
/// positive.
[[nodiscard]] std::optional<EdgeLine> parse_edge_line(std::string_view line);

}  // namespace waymark
