#pragma once

#include <memory>
#include <vector>

#include "core/detect/marker_detector.h"

namespace waymark {

/// OpenCV's ArUco detector (adaptive threshold, contours, quads, code), one pass per family. Its
/// own sub-pixel corners are off: they lie 0.12–0.47 px per edge inside.
/// It corrects as many bits as ours (correctable_bits). aruco_mip_36h12, which OpenCV 4.6 lacks, is
/// a dictionary made of our table. It does not tell how many bits were wrong.
class ArucoDetector final : public MarkerDetector {
 public:
  ArucoDetector(const std::vector<Family>& families, double min_side_px);
  ~ArucoDetector() override;

 private:
  [[nodiscard]] const std::vector<Detection>& find(const GrayView& image,
                                                   std::span<const ImageWindow> windows) override;
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace waymark
