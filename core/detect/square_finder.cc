#include "core/detect/square_finder.h"

#include <algorithm>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>

#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

ImageCorners clockwise(const std::vector<cv::Point2f>& quad) {
  ImageCorners corners;
  for (std::size_t i = 0; i < 4; ++i) corners[i] = {quad[i].x, quad[i].y};
  const Eigen::Vector2d across = corners[2] - corners[0];
  const Eigen::Vector2d down = corners[3] - corners[1];
  // The image's y runs down: clockwise corners have a positive area.
  if (across.x() * down.y() - across.y() * down.x() < 0) std::swap(corners[1], corners[3]);
  return corners;
}

/// Adds a square; of several in one place, the outline's two sides, the larger stays.
void add(const ImageCorners& square, std::vector<ImageCorners>& squares) {
  for (ImageCorners& known : squares) {
    const double larger_px = std::max(mean_side_px(known), mean_side_px(square));
    if ((centre_of(known) - centre_of(square)).norm() > 0.1 * larger_px) continue;
    if (std::min(mean_side_px(known), mean_side_px(square)) < 0.8 * larger_px) continue;
    if (mean_side_px(square) > mean_side_px(known)) known = square;
    return;
  }
  squares.push_back(square);
}

/// OpenCV reads the pixels only; its Mat has no constant form.
cv::Mat pixels_of(const GrayView& image) {
  return {image.height_px, image.width_px, CV_8UC1, const_cast<std::uint8_t*>(image.data),
          image.stride_bytes};
}

std::vector<ImageCorners> squares_in(const GrayView& image, double min_side_px) {
  std::vector<ImageCorners> squares;
  if (std::min(image.width_px, image.height_px) < min_side_px) return squares;
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  parameters->minMarkerPerimeterRate = 4 * min_side_px / std::max(image.width_px, image.height_px);
  parameters->minMarkerDistanceRate = 0.02;
  // Any dictionary will do: what it can't read is given back as well.
  static const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_16h5);
  std::vector<std::vector<cv::Point2f>> read;
  std::vector<std::vector<cv::Point2f>> unread;
  std::vector<int> numbers;
  cv::aruco::detectMarkers(pixels_of(image), dictionary, read, numbers, parameters, unread);
  for (const auto* quads : {&read, &unread}) {
    for (const auto& quad : *quads) add(clockwise(quad), squares);
  }
  return squares;
}

std::vector<ImageCorners> code_areas_in(const GrayView& image, double min_side_px) {
  std::vector<ImageCorners> areas;
  cv::Mat bright;
  cv::threshold(pixels_of(image), bright, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
  // Cells are of unknown size, and so are the gaps between white ones.
  for (const int radius_px : {3, 6, 12}) {
    cv::Mat closed;
    const cv::Size kernel(2 * radius_px + 1, 2 * radius_px + 1);
    cv::morphologyEx(bright, closed, cv::MORPH_CLOSE,
                     cv::getStructuringElement(cv::MORPH_RECT, kernel));
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(closed, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    for (const auto& contour : contours) {
      cv::RotatedRect area = cv::minAreaRect(contour);
      // From the outermost pixels' middles to their edges.
      area.size.width += 1;
      area.size.height += 1;
      const auto [shorter, longer] = std::minmax(area.size.width, area.size.height);
      constexpr double kLongest = 1.6;  // a square seen aslant
      if (shorter < min_side_px || longer > kLongest * shorter) continue;
      std::vector<cv::Point2f> corners(4);
      area.points(corners.data());
      areas.push_back(clockwise(corners));
    }
  }
  return areas;
}

/// OpenCV's exceptions stop here: in what it can't search there is nothing.
template <typename Find>
std::vector<ImageCorners> nothing_on_failure(const Find& find) {
  try {
    return find();
  } catch (const cv::Exception&) {
    return {};
  }
}

}  // namespace

std::vector<ImageCorners> find_squares(const GrayView& image, double min_side_px) {
  return nothing_on_failure([&] { return squares_in(image, min_side_px); });
}

std::vector<ImageCorners> find_code_areas(const GrayView& image, double min_side_px) {
  return nothing_on_failure([&] { return code_areas_in(image, min_side_px); });
}

}  // namespace waymark
