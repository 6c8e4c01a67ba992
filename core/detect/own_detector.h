#pragma once

#include <vector>

#include "core/detect/binomial_smoothing.h"
#include "core/detect/border_follower.h"
#include "core/detect/code_table.h"
#include "core/detect/dark_pixels.h"
#include "core/detect/marker_detector.h"
#include "core/detect/tile_thresholds.h"

namespace waymark {

/// Our own: borders of what is darker than its surroundings (TileThresholds, DarkPixels,
/// BorderFollower), quadrangles among them (fit_quad), the cells in each (read_quad_code), all
/// families in one pass (CodeTable). One thread; after some images of a size it allocates nothing.
class OwnDetector final : public MarkerDetector {
 public:
  OwnDetector(const std::vector<Family>& families, const DetectorOptions& options);

  [[nodiscard]] const std::vector<Detection>& find(const GrayView& image) override;

 private:
  void read_quad(const GrayView& image, const ImageCorners& quad);
  void add_reading(const Detection& reading);

  CodeTable codes_;
  double min_side_px_;
  BinomialSmoothing smoothing_;
  TileThresholds thresholds_;
  DarkPixels dark_;
  BorderFollower borders_;
  std::vector<CodeMatch> matches_;
  std::vector<Detection> detections_;
};

}  // namespace waymark
