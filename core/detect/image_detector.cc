#include "core/detect/image_detector.h"

#include <algorithm>
#include <utility>

#include "core/base/check.h"
#include "core/detect/aruco_detector.h"
#include "core/detect/cell_reader.h"
#include "core/marker/image_families.h"
#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

/// Whether two detections are readings of the same square.
bool same_square(const Detection& a, const Detection& b) {
  const Eigen::Vector2d between = centre_of(a.corners) - centre_of(b.corners);
  return between.norm() < 0.2 * mean_side_px(a.corners);
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
    : catalog_(catalog),
      options_(options),
      detector_(make_detector(families_in_images(catalog), options.detector)),
      bits_(families_in_images(catalog)) {
  WAYMARK_CHECK(options.check().has_value());
  for (const Family family : families_in_images(catalog)) {
    correctable_bits_[family] = correctable_bits(family);
  }
}

/// Exact corners of everything found that the catalog knows; what has none is counted.
void ImageDetector::refine_known(const GrayView& image, const CameraModel& camera) {
  refined_.clear();
  const std::vector<Detection>& all = detector_->detect(image);
  found_.failure = detector_->failure();
  for (const Detection& rough : all) {
    ++found_.counts.found;
    if (!catalog_.size_m(rough.marker)) {
      ++found_.counts.unknown;
      continue;
    }
    const auto corners =
        refine_corners(image, camera, rough.corners, bits_.of(rough.marker), options_.refine);
    if (corners) {
      refined_.push_back({rough, *corners});
    } else {
      ++found_.counts.unrefined;
    }
  }
}

/// Saturated paper hides how blurred its edges are; the image's other markers show it.
void ImageDetector::refine_saturated_again(const GrayView& image, const CameraModel& camera) {
  blur_.clear();
  for (const Refined& one : refined_) blur_.add(one.corners);
  RefineOptions options = options_.refine;
  options.blur = blur_.prior();
  if (!options.blur) return;
  for (Refined& one : refined_) {
    if (one.corners.saturated_share < kSaturatedPaper) continue;
    const auto corners =
        refine_corners(image, camera, one.rough.corners, bits_.of(one.rough.marker), options);
    if (corners) one.corners = *corners;
  }
}

/// What shows its marker's cells, read with the exact corners; the rest is counted.
void ImageDetector::keep_readable(const GrayView& image) {
  found_.detections.clear();
  for (const Refined& one : refined_) {
    const MarkerBits& bits = bits_.of(one.rough.marker);
    const auto reading = read_cells(image, one.corners.corners, bits);
    const int border_cells = 4 * (bits.cells - 1);
    if (!reading || reading->wrong_code_cells > correctable_bits_.at(one.rough.marker.family) ||
        reading->wrong_border_cells > border_cells / 8) {
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

const FoundMarkers& ImageDetector::detect(const GrayView& image, const CameraModel& camera) {
  WAYMARK_CHECK(image.width_px == camera.parameters().width_px &&
                image.height_px == camera.parameters().height_px);
  found_.counts = {};
  refine_known(image, camera);
  refine_saturated_again(image, camera);
  keep_readable(image);
  drop_ambiguous();
  found_.counts.kept = static_cast<int>(found_.detections.size());
  return found_;
}

}  // namespace waymark
