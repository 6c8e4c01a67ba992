#pragma once

#include <string>
#include <vector>

#include "core/camera/camera_model.h"
#include "mapbuilder/diagnosis/finding.h"

namespace waymark {

/// Where in a camera's image markers were seen.
struct ImageCoverage {
  std::string camera;
  double share = 0;  ///< of a 12 × 9 grid's cells, how many hold a corner or have one beside them
  std::vector<std::string> empty;     ///< "left", "middle", "right", "upper", "lower" thirds
  std::vector<std::string> remedies;  ///< of each, what to do
};

/// Of the corners of a camera's accepted observations (px). The thirds across and those from top to
/// bottom, each empty where it holds fewer than four corners. Of a fisheye's image the corners may
/// be black, never a third.
[[nodiscard]] ImageCoverage image_coverage(const std::string& camera, const CameraModel& model,
                                           const std::vector<Eigen::Vector2d>& corners_px);

/// A warning for what is empty; none where nothing is.
[[nodiscard]] std::vector<Finding> findings_of(const ImageCoverage& coverage);

}  // namespace waymark
