#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/detect/binomial_smoothing.h"
#include "core/detect/border_follower.h"
#include "core/detect/contrast_gates.h"
#include "core/detect/dark_pixels.h"
#include "core/detect/image_window.h"
#include "core/detect/tile_thresholds.h"
#include "core/marker/marker_geometry.h"

namespace waymark {

/// Finds dark quadrangles: borders of what is darker than its surroundings (TileThresholds,
/// DarkPixels, BorderFollower) that run along four straight sides (fit_quad). Noisy images are
/// smoothed. Keeps its memory: after some images of a size it allocates nothing.
class QuadSearch {
 public:
  /// Why an image can't be searched; nullptr for one that can.
  [[nodiscard]] static const char* why_not(const GrayView& image);

  /// Those of an image that can be searched, with a mean side of at least `min_side_px`: corners in
  /// the image's pixels, clockwise, any of them first. Valid until the next call.
  const std::vector<ImageCorners>& find(const GrayView& image, double min_side_px);

  /// The same of parts of an image. Places evenly over all of it tell its noise, so that a quad
  /// that lies well inside a window is found as in the whole image; one that lies in two windows is
  /// found twice. Of a window counts what lies in the image.
  const std::vector<ImageCorners>& find(const GrayView& image, double min_side_px,
                                        std::span<const ImageWindow> windows);

  /// Least contrast (grey levels) that is more than the last image's noise.
  [[nodiscard]] int gate_grey() const { return gates_.gate_grey(); }

 private:
  [[nodiscard]] bool is_noisy() const;
  void judge_noise(const GrayView& image, bool smoothed);
  void find_in(const GrayView& window, int row_px, double min_side_px,
               const Eigen::Vector2d& origin);

  ContrastGates gates_;
  BinomialSmoothing smoothing_;
  TileThresholds thresholds_;
  DarkPixels dark_;
  BorderFollower borders_;
  std::vector<ImageCorners> quads_;
};

}  // namespace waymark
