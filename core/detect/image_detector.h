#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/detect/common_blur.h"
#include "core/detect/corner_refiner.h"
#include "core/detect/marker_detector.h"
#include "core/detect/negative_image.h"
#include "core/marker/marker_bits.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// How markers are found in one image.
struct ImageDetectorOptions {
  DetectorOptions detector;  ///< what is printed inverted, the catalog says
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
  /// The catalog has an entry; the options are valid (checked).
  explicit ImageDetector(const MarkerCatalog& catalog, const ImageDetectorOptions& options = {});
  /// The same with somebody else's detector of the catalog's families.
  ImageDetector(const MarkerCatalog& catalog, std::unique_ptr<MarkerDetector> detector,
                const RefineOptions& refine = {});

  /// `camera` took the image and has its size (checked). Where windows are given, markers are
  /// looked for in these alone. Corners are moved outward by what the camera sees edges inside the
  /// black, `edge_bias_px`. The result is the detector's own, valid until the next call; after some
  /// images nothing is allocated.
  [[nodiscard]] const FoundMarkers& detect(const GrayView& image, const CameraModel& camera,
                                           std::span<const ImageWindow> windows = {},
                                           double edge_bias_px = 0);

 private:
  /// A marker of the catalog and its exact corners.
  struct Refined {
    Detection rough;
    MarkerBits bits;  ///< as `shown_dark` shows them
    RefinedCorners corners;
  };
  [[nodiscard]] const GrayView& shown_dark(const MarkerId& id) const;
  void refine_known(const CameraModel& camera, std::span<const ImageWindow> windows);
  void refine_saturated_again(const CameraModel& camera);
  void keep_readable();
  void drop_ambiguous();
  void correct_edges(double edge_bias_px);

  MarkerCatalog catalog_;
  RefineOptions refine_;
  std::unique_ptr<MarkerDetector> detector_;
  bool any_light_ = false;  ///< whether some family's squares are seen light in dark
  GrayView image_;
  GrayView negative_view_;
  FoundMarkers found_;
  std::vector<Refined> refined_;  ///< this and the next three kept for their memory
  NegativeImage negative_;
  CommonBlur blur_;
  std::vector<Detection> clear_;
};

}  // namespace waymark
