#include "core/detect/aruco_detector.h"

#include <algorithm>
#include <cmath>
#include <opencv2/aruco.hpp>

#include "core/detect/cell_reader.h"
#include "core/marker/marker_outline.h"
#include "core/marker/opencv_dictionary.h"

namespace waymark {
namespace {

/// Chance that random cells decode as some marker of the family, any way up, with up to
/// `corrected` wrong bits.
double random_acceptance(const FamilyTraits& family, int corrected) {
  const int bits = family.code_cells * family.code_cells;
  double patterns = 1;
  double combinations = 1;
  for (int wrong = 1; wrong <= corrected; ++wrong) {
    combinations *= static_cast<double>(bits - wrong + 1) / wrong;
    patterns += combinations;
  }
  return 4.0 * family.id_count * patterns / std::exp2(bits);
}

/// Bits that the distance between the family's codes lets correct without mistaking one for
/// another.
int bits_within_half_distance(Family family, const cv::aruco::Dictionary& dictionary) {
  switch (family) {
    case Family::tag16h5:
      return 2;
    case Family::tag25h9:
    case Family::tag36h10:
      return 4;
    case Family::tag36h11:
      return 5;
    default:
      return dictionary.maxCorrectionBits;
  }
}

cv::Ptr<cv::aruco::Dictionary> correcting_dictionary(Family family) {
  auto dictionary = cv::aruco::getPredefinedDictionary(opencv_dictionary(family));
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

int correctable_bits(Family family) {
  constexpr double kMaxRandomAcceptance = 1e-3;
  const auto dictionary = cv::aruco::getPredefinedDictionary(opencv_dictionary(family));
  int corrected = bits_within_half_distance(family, *dictionary);
  while (corrected > 0 && random_acceptance(traits(family), corrected) > kMaxRandomAcceptance) {
    --corrected;
  }
  return corrected;
}

struct ArucoDetector::Implementation {
  explicit Implementation(const std::vector<Family>& families) : bits(families) {}

  struct FamilyPass {
    Family family;
    cv::Ptr<cv::aruco::Dictionary> dictionary;
  };
  std::vector<FamilyPass> passes;
  cv::Ptr<cv::aruco::DetectorParameters> parameters = cv::aruco::DetectorParameters::create();
  double min_side_px = 0;
  MarkerBitsTable bits;
  // Kept from image to image for their memory.
  std::vector<std::vector<cv::Point2f>> quads;
  std::vector<int> numbers;
  std::vector<Detection> detections;
};

ArucoDetector::ArucoDetector(const std::vector<Family>& families, const DetectorOptions& options)
    : implementation_(std::make_unique<Implementation>(families)) {
  // OpenCV prints what it throws, beside the one line that we make of it.
  cv::redirectError([](int, const char*, const char*, const char*, int, void*) { return 0; });
  for (const Family family : families) {
    implementation_->passes.push_back({family, correcting_dictionary(family)});
  }
  implementation_->min_side_px = options.min_side_px;
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

const std::vector<Detection>& ArucoDetector::find(const GrayView& image) {
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
      const auto reading =
          read_cells(image, detection.corners, implementation_->bits.of(detection.marker));
      if (reading) detection.hamming = reading->wrong_code_cells;
      add_reading(detection, detections);
    }
  }
  return detections;
}

}  // namespace waymark
