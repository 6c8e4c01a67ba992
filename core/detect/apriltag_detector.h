#pragma once

#include <memory>
#include <vector>

#include "core/detect/marker_detector.h"

namespace waymark {

/// libapriltag's detector (gradient clusters, line fits, code) on the full-resolution image, one
/// thread, all its families in one pass. It corrects at most 2 bits: its tables grow with every
/// bit.
class ApriltagDetector final : public MarkerDetector {
 public:
  ApriltagDetector(const std::vector<Family>& families, const DetectorOptions& options);
  ~ApriltagDetector() override;

  [[nodiscard]] const std::vector<Detection>& find(const GrayView& image) override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace waymark
