#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/range.h"
#include "core/capture/detection.h"
#include "core/capture/gray_image.h"
#include "core/detect/image_window.h"
#include "core/marker/marker_layout.h"

namespace waymark {

/// Finds and decodes markers: the seam behind which our own detector stands, and other libraries'
/// as referees.
/// Corners are rough (about ±1 px), in the order and pixel convention of `ImageCorners`
/// (pixel centre at integers); refine_corners makes them exact. One detector per thread.
class MarkerDetector {
 public:
  MarkerDetector() = default;
  MarkerDetector(const MarkerDetector&) = delete;
  MarkerDetector& operator=(const MarkerDetector&) = delete;
  virtual ~MarkerDetector() = default;

  /// All markers of the detector's families, by rising (id, first corner); no covariances yet. The
  /// same id may appear twice. Same image, same result. Where `windows` are given, a detector may
  /// look in these alone, and finds there what it finds in the whole image. The result is the
  /// detector's own, valid until the next call. Nothing is found where the library behind it fails;
  /// `failure` says why. Never throws.
  [[nodiscard]] const std::vector<Detection>& detect(
      const GrayView& image, std::span<const ImageWindow> windows = {}) noexcept;

  /// Why the last image could not be searched; empty as a rule.
  [[nodiscard]] const std::string& failure() const { return failure_; }

 protected:
  /// The same in any order, which may throw what the library throws.
  [[nodiscard]] virtual const std::vector<Detection>& find(
      const GrayView& image, std::span<const ImageWindow> windows) = 0;

  void set_failure(const std::string& why) { failure_ = why; }

 private:
  std::vector<Detection> ordered_;
  std::string failure_;
};

/// What a detector looks for.
struct DetectorOptions {
  /// (8–1000 px) Shortest marker, as a quarter of its perimeter. Smaller ones are mostly
  /// undecodable, and every step down finds more false quads and takes more time.
  double min_side_px = 12;
  /// Families that are printed white for black.
  std::vector<Family> inverted = {};

  /// Whether the family's squares are seen light in dark.
  [[nodiscard]] bool shows_light_squares(Family family) const {
    const bool is_inverted = std::find(inverted.begin(), inverted.end(), family) != inverted.end();
    return marker_layout(family).is_light() != is_inverted;
  }

  /// usage, naming the field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Our own detector for all `families` (at least one; repeated ones count once), the best by
/// measurement: as much found as by any other in every bin of size and tilt but for one marker, in
/// a ninth to a sixtieth of the time (bench_detect_engines; bench/results.md). Options are valid
/// (checked).
[[nodiscard]] std::unique_ptr<MarkerDetector> make_detector(std::span<const Family> families,
                                                            const DetectorOptions& options = {});

}  // namespace waymark
