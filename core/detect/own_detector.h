#pragma once

#include <vector>

#include "core/detect/code_table.h"
#include "core/detect/marker_detector.h"
#include "core/detect/negative_image.h"
#include "core/detect/quad_search.h"

namespace waymark {

/// Our own: dark quadrangles (QuadSearch), the cells in each (read_quad_code), all families in one
/// pass (CodeTable); families with light squares in a negative, in another. One thread; after some
/// images of a size it allocates nothing.
class OwnDetector final : public MarkerDetector {
 public:
  OwnDetector(const std::vector<Family>& families, const DetectorOptions& options);

 private:
  [[nodiscard]] const std::vector<Detection>& find(const GrayView& image,
                                                   std::span<const ImageWindow> windows) override;
  void search(const GrayView& image, std::span<const ImageWindow> windows, const CodeTable& codes);
  void read_quad(const GrayView& image, const ImageCorners& quad, const CodeTable& codes);
  void add_reading(const Detection& reading);

  CodeTable dark_codes_;   ///< of families whose squares are dark
  CodeTable light_codes_;  ///< whose squares are light
  double min_side_px_;
  QuadSearch quads_;
  NegativeImage negative_;
  std::vector<CodeMatch> matches_;
  std::vector<Detection> detections_;
};

}  // namespace waymark
