#include "core/detect/square_finder.h"

#include <algorithm>

#include "core/detect/closed_areas.h"
#include "core/detect/quad_search.h"
#include "core/detect/smallest_rectangle.h"
#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

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

/// Black where the image is bright, or between what is.
GrayImage bright_areas(const GrayView& image, int radius_px) {
  GrayImage bright(image.width_px, image.height_px);
  const int threshold = dividing_grey(image);
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      bright.row(y)[x] = image.row(y)[x] > threshold ? 255 : 0;
    }
  }
  GrayImage areas = closed(bright, radius_px);
  for (std::uint8_t& grey : areas.pixels) grey = static_cast<std::uint8_t>(~grey);
  return areas;
}

/// Whether a border goes round an area and not round a hole in one.
bool goes_round_an_area(std::span<const Pixel> border) {
  long twice = 0;
  for (std::size_t i = 0; i < border.size(); ++i) {
    const Pixel& a = border[i];
    const Pixel& b = border[(i + 1) % border.size()];
    twice += long{a.x} * b.y - long{b.x} * a.y;
  }
  return twice > 0;
}

/// A square seen aslant, of some size.
bool may_be_code(const ImageCorners& area, double min_side_px) {
  constexpr double kLongest = 1.6;
  const double width = (area[1] - area[0]).norm();
  const double height = (area[3] - area[0]).norm();
  const auto [shorter, longer] = std::minmax(width, height);
  return shorter >= min_side_px && longer <= kLongest * shorter;
}

}  // namespace

std::vector<ImageCorners> find_squares(const GrayView& image, double min_side_px) {
  std::vector<ImageCorners> squares;
  if (QuadSearch::why_not(image) != nullptr) return squares;
  QuadSearch search;
  for (const ImageCorners& quad : search.find(image, min_side_px)) add(quad, squares);
  return squares;
}

std::vector<ImageCorners> find_code_areas(const GrayView& image, double min_side_px) {
  std::vector<ImageCorners> areas;
  if (QuadSearch::why_not(image) != nullptr) return areas;
  if (std::min(image.width_px, image.height_px) < TileThresholds::kTilePx) return areas;
  ContrastGates gates;
  TileThresholds thresholds;
  DarkPixels dark;
  BorderFollower borders;
  // Cells are of unknown size, and so are the gaps between white ones.
  for (const int radius_px : {3, 6, 12}) {
    const GrayImage bright = bright_areas(image, radius_px);
    thresholds.measure(bright.view(), gates);
    dark.find(bright.view(), thresholds, bright.width_px);
    borders.begin(dark);
    for (auto border = borders.next(); !border.empty(); border = borders.next()) {
      if (!goes_round_an_area(border)) continue;
      const auto area = smallest_rectangle(border);
      if (area && may_be_code(*area, min_side_px)) areas.push_back(*area);
    }
  }
  return areas;
}

}  // namespace waymark
