#include "core/detect/image_detector.h"

#include <algorithm>
#include <utility>

#include "core/base/check.h"
#include "core/detect/cell_reader.h"
#include "core/detect/code_table.h"
#include "core/detect/quad_search.h"
#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

/// Whether two detections are readings of the same square.
bool same_square(const Detection& a, const Detection& b) {
  const Eigen::Vector2d between = centre_of(a.corners) - centre_of(b.corners);
  return between.norm() < 0.2 * mean_side_px(a.corners);
}

std::vector<Family> families_of(const MarkerCatalog& catalog) {
  std::vector<Family> families;
  for (const auto& entry : catalog.entries()) families.push_back(entry.family);
  return families;
}

DetectorOptions options_for(const MarkerCatalog& catalog, DetectorOptions options) {
  for (const auto& entry : catalog.entries()) {
    if (entry.inverted) options.inverted.push_back(entry.family);
  }
  return options;
}

}  // namespace

Status ImageDetectorOptions::check() const {
  return RangeCheck().part("detector", detector.check()).part("refine", refine.check()).status();
}

DetectionCounts& DetectionCounts::operator+=(const DetectionCounts& other) {
  found += other.found;
  unknown += other.unknown;
  unrefined += other.unrefined;
  misread += other.misread;
  ambiguous += other.ambiguous;
  kept += other.kept;
  return *this;
}

ImageDetector::ImageDetector(const MarkerCatalog& catalog, const ImageDetectorOptions& options)
    : ImageDetector(catalog,
                    make_detector(families_of(catalog), options_for(catalog, options.detector)),
                    options.refine) {}

ImageDetector::ImageDetector(const MarkerCatalog& catalog, std::unique_ptr<MarkerDetector> detector,
                             const RefineOptions& refine)
    : catalog_(catalog), refine_(refine), detector_(std::move(detector)) {
  WAYMARK_CHECK(refine.check().has_value());
  for (const Family family : families_of(catalog)) {
    any_light_ = any_light_ || catalog.shows_light_squares(family);
  }
}

/// The image, or its negative, whichever shows the marker's square dark.
const GrayView& ImageDetector::shown_dark(const MarkerId& id) const {
  return catalog_.shows_light_squares(id.family) ? negative_view_ : image_;
}

/// Exact corners of everything found that the catalog knows; what has none is counted.
void ImageDetector::refine_known(const CameraModel& camera, std::span<const ImageWindow> windows) {
  refined_.clear();
  const std::vector<Detection>& all = detector_->detect(image_, windows);
  found_.failure = detector_->failure();
  for (const Detection& rough : all) {
    ++found_.counts.found;
    if (!catalog_.size_m(rough.marker)) {
      ++found_.counts.unknown;
      continue;
    }
    MarkerBits bits = marker_bits(rough.marker);
    if (bits.is_light()) bits = negative_of(bits);
    const auto corners =
        refine_corners(shown_dark(rough.marker), camera, rough.corners, bits, refine_);
    if (corners) {
      refined_.push_back({rough, bits, *corners});
    } else {
      ++found_.counts.unrefined;
    }
  }
}

/// Saturated paper hides how blurred its edges are; the image's other markers show it.
void ImageDetector::refine_saturated_again(const CameraModel& camera) {
  blur_.clear();
  for (const Refined& one : refined_) blur_.add(one.corners);
  RefineOptions options = refine_;
  options.blur = blur_.prior();
  if (!options.blur) return;
  for (Refined& one : refined_) {
    if (one.corners.saturated_share < kSaturatedPaper) continue;
    const auto corners =
        refine_corners(shown_dark(one.rough.marker), camera, one.rough.corners, one.bits, options);
    if (corners) one.corners = *corners;
  }
}

/// What shows its marker's cells, read with the exact corners; the rest is counted.
void ImageDetector::keep_readable() {
  found_.detections.clear();
  for (const Refined& one : refined_) {
    const auto reading = read_cells(shown_dark(one.rough.marker), one.corners.corners, one.bits);
    if (!reading || reading->wrong_code_cells > correctable_bits(one.rough.marker.family) ||
        reading->wrong_other_cells > reading->other_cells / 8) {
      ++found_.counts.misread;
      continue;
    }
    found_.detections.push_back({one.rough.marker, one.corners.corners, one.corners.covariances,
                                 reading->wrong_code_cells});
  }
}

/// Of several readings of one square only that with the fewest corrected bits stays; none when two
/// are equally good but name different markers.
void ImageDetector::drop_ambiguous() {
  clear_.clear();
  for (const Detection& one : found_.detections) {
    const bool beaten = std::any_of(
        found_.detections.begin(), found_.detections.end(), [&](const Detection& other) {
          return &other != &one && same_square(one, other) &&
                 (other.hamming < one.hamming ||
                  (other.hamming == one.hamming && (other.marker != one.marker || &other < &one)));
        });
    if (!beaten) clear_.push_back(one);
  }
  found_.counts.ambiguous = static_cast<int>(found_.detections.size() - clear_.size());
  std::swap(found_.detections, clear_);
}

void ImageDetector::correct_edges(double edge_bias_px) {
  for (Detection& one : found_.detections) {
    const bool light = catalog_.shows_light_squares(one.marker.family);
    move_sides_in(light ? edge_bias_px : -edge_bias_px, one.corners);
  }
}

const FoundMarkers& ImageDetector::detect(const GrayView& image, const CameraModel& camera,
                                          std::span<const ImageWindow> windows,
                                          double edge_bias_px) {
  WAYMARK_CHECK(image.width_px == camera.parameters().width_px &&
                image.height_px == camera.parameters().height_px);
  found_.counts = {};
  image_ = image;
  if (any_light_ && QuadSearch::why_not(image) == nullptr) negative_view_ = negative_.of(image);
  refine_known(camera, windows);
  refine_saturated_again(camera);
  keep_readable();
  drop_ambiguous();
  if (edge_bias_px != 0) correct_edges(edge_bias_px);
  found_.counts.kept = static_cast<int>(found_.detections.size());
  return found_;
}

}  // namespace waymark
