#include "core/marker/marker_bits.h"

#include <opencv2/aruco/dictionary.hpp>

#include "core/base/check.h"
#include "core/marker/opencv_dictionary.h"

namespace waymark {
namespace {

// OpenCV numbers its predefined dictionaries as `Family` does: the ArUco ones from DICT_4X4_50 on,
// then DICT_ARUCO_ORIGINAL, then the AprilTag ones.
static_assert(opencv_dictionary(Family::aruco_4x4_50) == cv::aruco::DICT_4X4_50);
static_assert(opencv_dictionary(Family::aruco_7x7_1000) == cv::aruco::DICT_7X7_1000);
static_assert(opencv_dictionary(Family::aruco_original) == cv::aruco::DICT_ARUCO_ORIGINAL);
static_assert(opencv_dictionary(Family::tag16h5) == cv::aruco::DICT_APRILTAG_16h5);
static_assert(opencv_dictionary(Family::tag36h11) == cv::aruco::DICT_APRILTAG_36h11);

}  // namespace

MarkerBits marker_bits(const MarkerId& id) {
  const FamilyTraits& family = traits(id.family);
  WAYMARK_CHECK(is_found_in_images(id.family));
  WAYMARK_CHECK(id.number >= 0 && id.number < family.id_count);
  const auto dictionary = cv::aruco::getPredefinedDictionary(opencv_dictionary(id.family));
  WAYMARK_CHECK(dictionary->markerSize == family.code_cells);
  WAYMARK_CHECK(dictionary->bytesList.rows == family.id_count);

  const cv::Mat code = cv::aruco::Dictionary::getBitsFromByteList(
      dictionary->bytesList.rowRange(id.number, id.number + 1), family.code_cells);
  MarkerBits bits;
  bits.cells = family.code_cells + 2;
  WAYMARK_CHECK(bits.cells <= kMaxMarkerCells);
  bits.white.assign(bits.index(bits.cells, 0), 0);
  const int last = family.code_cells - 1;
  const bool upside_down = opencv_draws_upside_down(id.family);
  for (int row = 0; row <= last; ++row) {
    for (int column = 0; column <= last; ++column) {
      const auto cell = upside_down ? code.at<std::uint8_t>(last - row, last - column)
                                    : code.at<std::uint8_t>(row, column);
      bits.white[bits.index(row + 1, column + 1)] = cell;
    }
  }
  return bits;
}

MarkerBitsTable::MarkerBitsTable(std::span<const Family> families) {
  for (const Family family : families) {
    std::vector<MarkerBits>& markers = families_[family];
    markers.clear();
    for (int number = 0; number < traits(family).id_count; ++number) {
      markers.push_back(marker_bits({family, number}));
    }
  }
}

const MarkerBits& MarkerBitsTable::of(const MarkerId& id) const {
  const auto family = families_.find(id.family);
  WAYMARK_CHECK(family != families_.end());
  WAYMARK_CHECK(id.number >= 0 && id.number < static_cast<int>(family->second.size()));
  return family->second[static_cast<std::size_t>(id.number)];
}

}  // namespace waymark
