#pragma once

#include <memory>
#include <vector>

#include "core/detect/marker_detector.h"

namespace waymark {

/// libapriltag's detector (gradient clusters, line fits, code) on the full-resolution image, one
/// thread, all its families in one pass. It corrects at most 2 bits, none in families of more than
/// 10,000 ids: its tables grow with every bit.
class ApriltagDetector final : public MarkerDetector {
 public:
  ApriltagDetector(const std::vector<Family>& families, double min_side_px);
  ~ApriltagDetector() override;

 private:
  [[nodiscard]] const std::vector<Detection>& find(const GrayView& image,
                                                   std::span<const ImageWindow> windows) override;
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace waymark
