#include "core/detect/cell_reader.h"

#include <gtest/gtest.h>

#include "tests/support/corner_trials.h"

namespace waymark {
namespace {

using testing::MarkerView;
using testing::RenderedMarker;

class CellReader : public ::testing::Test {
 protected:
  CellReader() {
    marker_.id = {Family::aruco_6x6_250, 42};
    marker_.cam_from_marker =
        pose_seen_as(camera_, MarkerView{{150, 170}, 50, 0.7, 2.0, 0.5}, marker_.size_m);
    image_ = testing::render_markers(camera_, {&marker_, 1}, {});
    corners_ = true_corners(camera_, marker_);
  }

  CameraModel camera_ = testing::trial_camera();
  RenderedMarker marker_;
  GrayImage image_;
  ImageCorners corners_;
};

TEST_F(CellReader, ReadsItsOwnMarkerWithoutError) {
  const auto reading = read_cells(image_.view(), corners_, marker_bits(marker_.id));
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->wrong_code_cells, 0);
  EXPECT_EQ(reading->wrong_other_cells, 0);
  EXPECT_GT(reading->contrast_grey, 140);
}

TEST_F(CellReader, CountsTheCellsOfAnotherMarker) {
  const MarkerBits own = marker_bits(marker_.id);
  MarkerBits other = own;
  for (const std::size_t code_cell : {9U, 10U, 18U}) other.white[code_cell] ^= 1U;
  const auto reading = read_cells(image_.view(), corners_, other);
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->wrong_code_cells, 3);
  EXPECT_EQ(reading->wrong_other_cells, 0);
}

TEST_F(CellReader, SeesAPaintedBorder) {
  const Eigen::Vector2d corner = corners_[0];
  for (int y = -6; y <= 6; ++y) {
    for (int x = -6; x <= 6; ++x) {
      image_.row(static_cast<int>(corner.y()) + y)[static_cast<int>(corner.x()) + x] = 220;
    }
  }
  const auto reading = read_cells(image_.view(), corners_, marker_bits(marker_.id));
  ASSERT_TRUE(reading);
  EXPECT_GE(reading->wrong_other_cells, 1);
}

TEST_F(CellReader, NothingOutsideTheImageOrOnALine) {
  const MarkerBits bits = marker_bits(marker_.id);
  ImageCorners outside = corners_;
  for (Eigen::Vector2d& corner : outside) corner.x() += 150;
  EXPECT_FALSE(read_cells(image_.view(), outside, bits));
  EXPECT_FALSE(
      read_cells(image_.view(), {corners_[0], corners_[1], corners_[0], corners_[1]}, bits));
}

}  // namespace
}  // namespace waymark
