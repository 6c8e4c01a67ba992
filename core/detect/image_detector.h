#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/detect/common_blur.h"
#include "core/detect/corner_refiner.h"
#include "core/detect/marker_detector.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// How markers are found in one image.
struct ImageDetectorOptions {
  DetectorOptions detector;
  RefineOptions refine;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// What became of everything that looked like a marker, summed over images.
struct DetectionCounts {
  int found = 0;      ///< by the detector, in the families of the catalog
  int unknown = 0;    ///< ids that the catalog ignores or lacks
  int unrefined = 0;  ///< no exact corners: covered, too small, false quads
  int misread = 0;    ///< with exact corners, the cells do not show the marker
  int ambiguous = 0;  ///< the same square read as two markers
  int kept = 0;

  DetectionCounts& operator+=(const DetectionCounts& other);
};

/// Markers of one image.
struct FoundMarkers {
  std::vector<Detection> detections;  ///< by rising (id, first corner), every one with covariances
  DetectionCounts counts;
  std::string failure;  ///< why the image could not be searched; empty as a rule
};

/// Finds the markers of a catalog in images: find and decode, refine the corners (those on
/// saturated paper with the blur that the image's others show), read the cells again with them.
/// What can't be refined or read is dropped and counted. Deterministic; one per thread.
class ImageDetector {
 public:
  /// The catalog has an entry of a family that is found in images; the options are valid (checked).
  explicit ImageDetector(const MarkerCatalog& catalog, const ImageDetectorOptions& options = {});

  /// `camera` took the image and has its size (checked). The result is the detector's own, valid
  /// until the next call; after some images nothing is allocated here, only by the library.
  [[nodiscard]] const FoundMarkers& detect(const GrayView& image, const CameraModel& camera);

 private:
  /// A marker of the catalog and its exact corners.
  struct Refined {
    Detection rough;
    RefinedCorners corners;
  };
  void refine_known(const GrayView& image, const CameraModel& camera);
  void refine_saturated_again(const GrayView& image, const CameraModel& camera);
  void keep_readable(const GrayView& image);
  void drop_ambiguous();

  MarkerCatalog catalog_;
  ImageDetectorOptions options_;
  std::unique_ptr<MarkerDetector> detector_;
  MarkerBitsTable bits_;
  std::map<Family, int> correctable_bits_;
  FoundMarkers found_;
  std::vector<Refined> refined_;  ///< this and the next two kept for their memory
  CommonBlur blur_;
  std::vector<Detection> clear_;
};

}  // namespace waymark
