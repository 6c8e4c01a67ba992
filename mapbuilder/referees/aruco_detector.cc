#include "mapbuilder/referees/aruco_detector.h"

#include <algorithm>
#include <opencv2/aruco.hpp>

#include "core/detect/code_table.h"
#include "core/marker/marker_codes.h"
#include "core/marker/marker_layout.h"
#include "core/marker/marker_outline.h"
#include "mapbuilder/referees/opencv_dictionary.h"

namespace waymark {
namespace {

/// The dictionary of a family that OpenCV lacks.
cv::Ptr<cv::aruco::Dictionary> made_dictionary(Family family) {
  auto dictionary = cv::makePtr<cv::aruco::Dictionary>();
  dictionary->markerSize = marker_layout(family).square_cells() - 2;
  cv::Mat cells(dictionary->markerSize, dictionary->markerSize, CV_8UC1);
  for (int number = 0; number < traits(family).id_count; ++number) {
    const std::uint64_t code = marker_code({family, number});
    for (int i = 0; i < traits(family).code_bits; ++i) cells.data[i] = code >> i & 1U;
    dictionary->bytesList.push_back(cv::aruco::Dictionary::getByteListFromBits(cells));
  }
  return dictionary;
}

cv::Ptr<cv::aruco::Dictionary> correcting_dictionary(Family family) {
  auto dictionary = is_in_opencv(family)
                        ? cv::aruco::getPredefinedDictionary(opencv_dictionary(family))
                        : made_dictionary(family);
  dictionary->maxCorrectionBits = correctable_bits(family);
  return dictionary;
}

ImageCorners upright_corners(Family family, const std::vector<cv::Point2f>& found) {
  const std::size_t turn = opencv_draws_upside_down(family) ? 2 : 0;
  ImageCorners corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const cv::Point2f& p = found[(i + turn) % 4];
    corners[i] = {p.x, p.y};
  }
  return corners;
}

/// Whether both are the same marker in the same place.
bool same_reading(const Detection& a, const Detection& b) {
  if (a.marker != b.marker) return false;
  const Eigen::Vector2d between = centre_of(a.corners) - centre_of(b.corners);
  return between.norm() < 0.2 * mean_side_px(a.corners);
}

/// Adds a reading; of several of one marker in one place the outermost stays.
void add_reading(const Detection& reading, std::vector<Detection>& detections) {
  for (Detection& known : detections) {
    if (!same_reading(known, reading)) continue;
    if (mean_side_px(reading.corners) > mean_side_px(known.corners)) known = reading;
    return;
  }
  detections.push_back(reading);
}

}  // namespace

struct ArucoDetector::Implementation {
  struct FamilyPass {
    Family family;
    cv::Ptr<cv::aruco::Dictionary> dictionary;
  };
  std::vector<FamilyPass> passes;
  cv::Ptr<cv::aruco::DetectorParameters> parameters = cv::aruco::DetectorParameters::create();
  double min_side_px = 0;
  // Kept from image to image for their memory.
  std::vector<std::vector<cv::Point2f>> quads;
  std::vector<int> numbers;
  std::vector<Detection> detections;
};

ArucoDetector::ArucoDetector(const std::vector<Family>& families, double min_side_px)
    : implementation_(std::make_unique<Implementation>()) {
  // Detectors run in threads of their own, one image each.
  cv::setNumThreads(1);
  // OpenCV prints what it throws, beside the one line that we make of it.
  cv::redirectError([](int, const char*, const char*, const char*, int, void*) { return 0; });
  for (const Family family : families) {
    implementation_->passes.push_back({family, correcting_dictionary(family)});
  }
  implementation_->min_side_px = min_side_px;
  cv::aruco::DetectorParameters& p = *implementation_->parameters;
  p.errorCorrectionRate = 1.0;  // of the dictionary's maxCorrectionBits, set above
  p.cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  // OpenCV's 0.05 takes the outline of paper with one cell of margin for the marker's, and drops
  // the marker; the readings of a border's two outlines are merged below instead.
  p.minMarkerDistanceRate = 0.02;
  // Only the middle of a cell, finely sampled, survives corners that are 1 px off.
  p.perspectiveRemovePixelPerCell = 8;
  p.perspectiveRemoveIgnoredMarginPerCell = 0.3;
}

ArucoDetector::~ArucoDetector() = default;

const std::vector<Detection>& ArucoDetector::find(const GrayView& image,
                                                  std::span<const ImageWindow>) {
  std::vector<Detection>& detections = implementation_->detections;
  std::vector<std::vector<cv::Point2f>>& quads = implementation_->quads;
  std::vector<int>& numbers = implementation_->numbers;
  detections.clear();
  const int longer_side = std::max(image.width_px, image.height_px);
  if (std::min(image.width_px, image.height_px) < implementation_->min_side_px) return detections;

  // OpenCV reads the pixels only; its Mat has no constant form.
  const cv::Mat pixels(image.height_px, image.width_px, CV_8UC1,
                       const_cast<std::uint8_t*>(image.data), image.stride_bytes);
  implementation_->parameters->minMarkerPerimeterRate =
      4 * implementation_->min_side_px / longer_side;
  for (const auto& pass : implementation_->passes) {
    cv::aruco::detectMarkers(pixels, pass.dictionary, quads, numbers, implementation_->parameters);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      Detection detection;
      detection.marker = {pass.family, numbers[i]};
      detection.corners = upright_corners(pass.family, quads[i]);
      add_reading(detection, detections);
    }
  }
  return detections;
}

}  // namespace waymark
