#include "mapbuilder/referees/apriltag_detector.h"

#include <apriltag/apriltag.h>

#include <algorithm>

#include "core/base/check.h"
#include "core/detect/code_table.h"
#include "mapbuilder/referees/apriltag_family.h"

namespace waymark {
namespace {

/// libapriltag goes bottom-left, bottom-right, top-right, top-left, and has the first pixel's
/// centre at (0.5, 0.5).
ImageCorners corners_of(const apriltag_detection_t& found) {
  ImageCorners corners;
  for (std::size_t i = 0; i < 4; ++i) {
    corners[i] = {found.p[3 - i][0] - 0.5, found.p[3 - i][1] - 0.5};
  }
  return corners;
}

/// libapriltag's tables grow with every bit and every id: two bits of tagStandard52h13 are 3 GB.
int corrected_bits(Family family) {
  constexpr int kMostBits = 2;
  constexpr int kManyIds = 10'000;
  return traits(family).id_count > kManyIds ? 0 : std::min(kMostBits, correctable_bits(family));
}

}  // namespace

struct ApriltagDetector::Implementation {
  struct AddedFamily {
    const ApriltagFamily* family;
    apriltag_family_t* tags;
  };
  apriltag_detector_t* detector = apriltag_detector_create();
  std::vector<AddedFamily> families;
  std::vector<Detection> detections;
  double min_side_px = 0;

  [[nodiscard]] Family family_of(const apriltag_detection_t& found) const {
    for (const AddedFamily& added : families) {
      if (added.tags == found.family) return added.family->family;
    }
    WAYMARK_CHECK(false);
    return Family::tag36h11;
  }
};

ApriltagDetector::ApriltagDetector(const std::vector<Family>& families, double min_side_px)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  for (const Family family : families) {
    const ApriltagFamily* const known = apriltag_family(family);
    WAYMARK_CHECK(known != nullptr);
    apriltag_family_t* tags = known->create();
    apriltag_detector_add_family_bits(self.detector, tags, corrected_bits(family));
    self.families.push_back({known, tags});
  }
  self.min_side_px = min_side_px;
  self.detector->nthreads = 1;
  self.detector->quad_decimate = 1;
  self.detector->refine_edges = false;
}

ApriltagDetector::~ApriltagDetector() {
  apriltag_detector_destroy(implementation_->detector);
  for (const auto& added : implementation_->families) added.family->destroy(added.tags);
}

const std::vector<Detection>& ApriltagDetector::find(const GrayView& image,
                                                     std::span<const ImageWindow>) {
  std::vector<Detection>& detections = implementation_->detections;
  detections.clear();
  const double min_side_px = implementation_->min_side_px;
  if (std::min(image.width_px, image.height_px) < min_side_px) return detections;
  // libapriltag reads the pixels only; its image has no constant form.
  image_u8_t pixels{image.width_px, image.height_px, static_cast<int>(image.stride_bytes),
                    const_cast<std::uint8_t*>(image.data)};
  zarray_t* found = apriltag_detector_detect(implementation_->detector, &pixels);
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* tag = nullptr;
    zarray_get(found, i, static_cast<void*>(&tag));
    Detection detection;
    detection.marker = {implementation_->family_of(*tag), tag->id};
    detection.corners = corners_of(*tag);
    detection.hamming = tag->hamming;
    double perimeter_px = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      perimeter_px += (detection.corners[(k + 1) % 4] - detection.corners[k]).norm();
    }
    if (perimeter_px >= 4 * min_side_px) detections.push_back(detection);
  }
  apriltag_detections_destroy(found);
  return detections;
}

}  // namespace waymark
