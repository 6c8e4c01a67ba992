#include "core/detect/apriltag_detector.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>

#include <algorithm>

#include "core/base/check.h"
#include "core/detect/aruco_detector.h"

namespace waymark {
namespace {

struct LibraryFamily {
  Family family;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr LibraryFamily kLibraryFamilies[] = {
    {Family::tag16h5, tag16h5_create, tag16h5_destroy},
    {Family::tag25h9, tag25h9_create, tag25h9_destroy},
    {Family::tag36h10, tag36h10_create, tag36h10_destroy},
    {Family::tag36h11, tag36h11_create, tag36h11_destroy},
};

const LibraryFamily& library_family(Family family) {
  const auto* found =
      std::find_if(std::begin(kLibraryFamilies), std::end(kLibraryFamilies),
                   [&](const LibraryFamily& candidate) { return candidate.family == family; });
  WAYMARK_CHECK(found != std::end(kLibraryFamilies));
  return *found;
}

/// libapriltag goes bottom-left, bottom-right, top-right, top-left, and has the first pixel's
/// centre at (0.5, 0.5).
ImageCorners corners_of(const apriltag_detection_t& found) {
  ImageCorners corners;
  for (std::size_t i = 0; i < 4; ++i) {
    corners[i] = {found.p[3 - i][0] - 0.5, found.p[3 - i][1] - 0.5};
  }
  return corners;
}

}  // namespace

struct ApriltagDetector::Implementation {
  struct AddedFamily {
    Family family;
    apriltag_family_t* tags;
  };
  apriltag_detector_t* detector = apriltag_detector_create();
  std::vector<AddedFamily> families;
  std::vector<Detection> detections;
  double min_side_px = 0;

  [[nodiscard]] Family family_of(const apriltag_detection_t& found) const {
    for (const AddedFamily& added : families) {
      if (added.tags == found.family) return added.family;
    }
    WAYMARK_CHECK(false);
    return Family::tag36h11;
  }
};

ApriltagDetector::ApriltagDetector(const std::vector<Family>& families,
                                   const DetectorOptions& options)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  constexpr int kMaxCorrectedBits = 2;
  for (const Family family : families) {
    apriltag_family_t* tags = library_family(family).create();
    apriltag_detector_add_family_bits(self.detector, tags,
                                      std::min(kMaxCorrectedBits, correctable_bits(family)));
    self.families.push_back({family, tags});
  }
  self.min_side_px = options.min_side_px;
  self.detector->nthreads = 1;
  self.detector->quad_decimate = 1;
  self.detector->refine_edges = false;
}

ApriltagDetector::~ApriltagDetector() {
  apriltag_detector_destroy(implementation_->detector);
  for (const auto& added : implementation_->families) {
    library_family(added.family).destroy(added.tags);
  }
}

const std::vector<Detection>& ApriltagDetector::find(const GrayView& image) {
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
