#pragma once

#include <memory>
#include <vector>

#include "core/detect/marker_detector.h"

namespace waymark {

/// OpenCV's ArUco detector (adaptive threshold, contours, quads, code), one pass per family. Its
/// own sub-pixel corners are off: they lie 0.12–0.47 px per edge inside.
///
/// Corrected bits per family: as many as its codes' distance allows (OpenCV's table; half the
/// distance for the tag families, whose entries OpenCV leaves at 0) while random cells decode
/// with a chance of at most 1e-3, so 36h11 corrects 3 bits, 4x4_1000 none.
class ArucoDetector final : public MarkerDetector {
 public:
  ArucoDetector(const std::vector<Family>& families, const DetectorOptions& options);
  ~ArucoDetector() override;

  [[nodiscard]] const std::vector<Detection>& find(const GrayView& image) override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Code bits that the detectors may correct in a family, see ArucoDetector.
[[nodiscard]] int correctable_bits(Family family);

}  // namespace waymark
