#include "core/detect/own_detector.h"

#include <algorithm>

#include "core/detect/quad_code.h"
#include "core/detect/quad_fitter.h"
#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

/// Whether both are the same marker in the same place.
bool same_reading(const Detection& a, const Detection& b) {
  if (a.marker != b.marker) return false;
  const Eigen::Vector2d between = centre_of(a.corners) - centre_of(b.corners);
  return between.norm() < 0.2 * mean_side_px(a.corners);
}

/// nullptr for an image that can be searched.
const char* why_not_searched(const GrayView& image) {
  if (image.data == nullptr) return "it has no pixels";
  if (image.stride_bytes < static_cast<std::size_t>(image.width_px)) return "its rows overlap";
  if (std::max(image.width_px, image.height_px) >= BorderFollower::kSizeLimitPx) {
    return "it is wider or higher than 32767 pixels";
  }
  return nullptr;
}

}  // namespace

OwnDetector::OwnDetector(const std::vector<Family>& families, const DetectorOptions& options)
    : codes_(families), min_side_px_(options.min_side_px) {}

/// Of several of one marker in one place the outermost stays.
void OwnDetector::add_reading(const Detection& reading) {
  for (Detection& known : detections_) {
    if (!same_reading(known, reading)) continue;
    if (mean_side_px(reading.corners) > mean_side_px(known.corners)) known = reading;
    return;
  }
  detections_.push_back(reading);
}

void OwnDetector::read_quad(const GrayView& image, const ImageCorners& quad) {
  const double least_contrast = 0.5 * thresholds_.gate_grey();
  for (const int code_cells : codes_.sizes()) {
    const auto seen = read_quad_code(image, quad, code_cells, least_contrast);
    if (!seen) continue;
    matches_.clear();
    codes_.find(code_cells, seen->code, matches_);
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

const std::vector<Detection>& OwnDetector::find(const GrayView& image) {
  detections_.clear();
  if (std::min(image.width_px, image.height_px) < min_side_px_) return detections_;
  if (const char* why = why_not_searched(image)) {
    set_failure(why);
    return detections_;
  }
  // Noise of 3 grey levels or so; smoothing would only cost small markers their margins.
  constexpr int kNoisyGate = 32;
  GrayView searched = image;
  thresholds_.measure(searched);
  if (thresholds_.gate_grey() > kNoisyGate) {
    searched = smoothing_.smoothed(image);
    thresholds_.measure(searched);
  }
  dark_.find(searched, thresholds_);
  borders_.begin(dark_);
  for (auto border = borders_.next(); !border.empty(); border = borders_.next()) {
    const auto quad = fit_quad(searched, thresholds_, border, min_side_px_);
    if (quad) read_quad(image, *quad);
  }
  return detections_;
}

}  // namespace waymark
