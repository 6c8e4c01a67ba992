#include "core/detect/image_detector.h"

#include <algorithm>
#include <utility>

#include "core/base/check.h"
#include "core/detect/aruco_detector.h"
#include "core/detect/cell_reader.h"

namespace waymark {
namespace {

std::vector<Family> families_of(const MarkerCatalog& catalog) {
  std::vector<Family> families;
  for (const auto& entry : catalog.entries()) families.push_back(entry.family);
  return families;
}

/// Whether two detections are readings of the same square.
bool same_square(const Detection& a, const Detection& b) {
  Eigen::Vector2d between = Eigen::Vector2d::Zero();
  double side_px = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    between += 0.25 * (a.corners[i] - b.corners[i]);
    side_px += 0.25 * (a.corners[(i + 1) % 4] - a.corners[i]).norm();
  }
  return between.norm() < 0.2 * side_px;
}

}  // namespace

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
      detector_(make_detector(families_of(catalog), options.detector)),
      bits_(families_of(catalog)) {
  for (const Family family : families_of(catalog)) {
    correctable_bits_[family] = correctable_bits(family);
  }
}

/// Gives the detection exact corners and covariances; false, counted, where it is none.
bool ImageDetector::refine(const GrayView& image, const CameraModel& camera, Detection& detection) {
  const MarkerBits& bits = bits_.of(detection.marker);
  const auto refined = refine_corners(image, camera, detection.corners, bits, options_.refine);
  if (!refined) {
    ++found_.counts.unrefined;
    return false;
  }
  const auto reading = read_cells(image, refined->corners, bits);
  const int border_cells = 4 * (bits.cells - 1);
  if (!reading || reading->wrong_code_cells > correctable_bits_.at(detection.marker.family) ||
      reading->wrong_border_cells > border_cells / 8) {
    ++found_.counts.misread;
    return false;
  }
  detection.hamming = reading->wrong_code_cells;
  detection.corners = refined->corners;
  detection.covariances = refined->covariances;
  return true;
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
  found_.detections.clear();
  found_.counts = {};
  for (const Detection& rough : detector_->detect(image)) {
    ++found_.counts.found;
    Detection detection = rough;
    if (!catalog_.size_m(detection.marker)) {
      ++found_.counts.unknown;
    } else if (refine(image, camera, detection)) {
      found_.detections.push_back(detection);
    }
  }
  drop_ambiguous();
  found_.counts.kept = static_cast<int>(found_.detections.size());
  return found_;
}

}  // namespace waymark
