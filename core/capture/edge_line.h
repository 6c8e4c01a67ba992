#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/camera/edge_measurement.h"

namespace waymark {

inline constexpr std::string_view kEdgeLinePrefix = "# edges camera=";

/// What a detections.csv says of one camera whose corners were moved outward:
/// `# edges camera=cam0 bias_px=0.2680 sigma_px=0.0090 response=srgb` (linear, srgb, open).
[[nodiscard]] std::string edge_line(std::string_view camera, const EdgeMeasurement& edges);

/// Such a line, taken apart.
struct EdgeLine {
  std::string camera;
  EdgeMeasurement edges;
};

/// nullopt where the line is none, or a number is none, is not finite, or is a sigma that is not
/// positive.
[[nodiscard]] std::optional<EdgeLine> parse_edge_line(std::string_view line);

}  // namespace waymark
