#include "core/detect/own_detector.h"

#include <algorithm>

#include "core/detect/quad_code.h"
#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

/// Whether both are the same marker in the same place.
bool same_reading(const Detection& a, const Detection& b) {
  if (a.marker != b.marker) return false;
  const Eigen::Vector2d between = centre_of(a.corners) - centre_of(b.corners);
  return between.norm() < 0.2 * mean_side_px(a.corners);
}

/// The families whose squares are printed light, or dark.
std::vector<Family> printed(const std::vector<Family>& families, const DetectorOptions& options,
                            bool light) {
  std::vector<Family> chosen;
  for (const Family family : families) {
    if (options.shows_light_squares(family) == light) chosen.push_back(family);
  }
  return chosen;
}

}  // namespace

OwnDetector::OwnDetector(const std::vector<Family>& families, const DetectorOptions& options)
    : dark_codes_(printed(families, options, false)),
      light_codes_(printed(families, options, true)),
      min_side_px_(options.min_side_px) {}

/// Of several of one marker in one place the outermost stays.
void OwnDetector::add_reading(const Detection& reading) {
  for (Detection& known : detections_) {
    if (!same_reading(known, reading)) continue;
    if (mean_side_px(reading.corners) > mean_side_px(known.corners)) known = reading;
    return;
  }
  detections_.push_back(reading);
}

void OwnDetector::read_quad(const GrayView& image, const ImageCorners& quad,
                            const CodeTable& codes) {
  const double least_contrast = 0.5 * quads_.gate_grey();
  for (const MarkerLayout* const layout : codes.layouts()) {
    const auto seen = read_quad_code(image, quad, *layout, least_contrast);
    if (!seen) continue;
    matches_.clear();
    codes.find(*layout, seen->code, matches_);
    for (const CodeMatch& match : matches_) {
      Detection reading;
      reading.marker = match.marker;
      reading.hamming = match.wrong_bits;
      for (std::size_t i = 0; i < 4; ++i) {
        reading.corners[i] = quad[(i + static_cast<std::size_t>(match.turn)) % 4];
      }
      add_reading(reading);
    }
  }
}

void OwnDetector::search(const GrayView& image, std::span<const ImageWindow> windows,
                         const CodeTable& codes) {
  const auto& quads = windows.empty() ? quads_.find(image, min_side_px_)
                                      : quads_.find(image, min_side_px_, windows);
  for (const ImageCorners& quad : quads) read_quad(image, quad, codes);
}

const std::vector<Detection>& OwnDetector::find(const GrayView& image,
                                                std::span<const ImageWindow> windows) {
  detections_.clear();
  if (std::min(image.width_px, image.height_px) < min_side_px_) return detections_;
  if (const char* why = QuadSearch::why_not(image)) {
    set_failure(why);
    return detections_;
  }
  if (!dark_codes_.layouts().empty()) search(image, windows, dark_codes_);
  if (!light_codes_.layouts().empty()) search(negative_.of(image), windows, light_codes_);
  return detections_;
}

}  // namespace waymark
