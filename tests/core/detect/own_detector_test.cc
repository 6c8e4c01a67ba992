#include "core/detect/own_detector.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/allocation_count.h"
#include "tests/support/corner_trials.h"

namespace waymark {
namespace {

using testing::MarkerView;
using testing::RenderedMarker;

/// Twelve markers of two families at all sizes and tilts.
class Markers : public ::testing::Test {
 protected:
  Markers() {
    for (int i = 0; i < 12; ++i) {
      RenderedMarker marker;
      marker.id = {i % 2 == 0 ? Family::aruco_4x4_1000 : Family::tag36h11, 10 + i};
      const MarkerView view{
          {110.0 + 190 * (i % 4), 110.0 + 190 * (i / 4)}, 24.0 + 6 * i, 0.1 * i, 0.7 * i, 0.4 * i};
      marker.cam_from_marker = pose_seen_as(camera_, view, marker.size_m);
      markers_.push_back(marker);
    }
  }

  [[nodiscard]] GrayImage image(double noise_grey = 2) const {
    testing::RenderOptions options;
    options.noise_grey = noise_grey;
    return testing::render_markers(camera_, markers_, options);
  }

  void expect_all_found(OwnDetector& detector, const GrayView& view) {
    const auto& found = detector.detect(view);
    EXPECT_EQ(found.size(), markers_.size());
    for (const RenderedMarker& marker : markers_) {
      const auto one = std::find_if(found.begin(), found.end(), [&](const Detection& detection) {
        return detection.marker == marker.id;
      });
      ASSERT_NE(one, found.end()) << marker.id.number;
      const ImageCorners truth = true_corners(camera_, marker);
      for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((one->corners[k] - truth[k]).norm(), 1.5);
    }
  }

  CameraModel camera_ = *CameraModel::create({800, 600, 700, 700, 399.5, 299.5});
  std::vector<RenderedMarker> markers_;
  OwnDetector detector_{{Family::aruco_4x4_1000, Family::tag36h11}, {}};
};

TEST_F(Markers, AreFoundInOnePassWithTheirCorners) { expect_all_found(detector_, image().view()); }

TEST_F(Markers, AreFoundInNoise) { expect_all_found(detector_, image(14).view()); }

TEST_F(Markers, AreFoundTheSameAgainWithoutAnyAllocation) {
  const GrayImage quiet = image();
  const GrayImage noisy = image(14);
  const std::vector<Detection> first = detector_.detect(quiet.view());
  (void)detector_.detect(noisy.view());
  const long before = testing::allocations();
  (void)detector_.detect(noisy.view());
  const std::vector<Detection>& again = detector_.detect(quiet.view());
  EXPECT_EQ(testing::allocations() - before, 0);
  ASSERT_EQ(again.size(), first.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(again[i].corners, first[i].corners);
}

TEST_F(Markers, WrongBitsAreCountedAndCorrected) {
  markers_.resize(2);
  GrayImage one_wrong = image();
  const ImageCorners corners = true_corners(camera_, markers_[1]);
  // A white cell's middle, next to the marker's top left, is painted black.
  const MarkerBits bits = marker_bits(markers_[1].id);
  for (int cell = 1; cell < bits.cells - 1; ++cell) {
    if (!bits.is_white(1, cell)) continue;
    const double along = (cell + 0.5) / bits.cells;
    const double down = 1.5 / bits.cells;
    const Eigen::Vector2d at =
        corners[0] + along * (corners[1] - corners[0]) + down * (corners[3] - corners[0]);
    for (int y = -2; y <= 2; ++y) {
      for (int x = -2; x <= 2; ++x) {
        one_wrong.row(static_cast<int>(at.y()) + y)[static_cast<int>(at.x()) + x] = 40;
      }
    }
    break;
  }
  const auto& found = detector_.detect(one_wrong.view());
  const auto tag = std::find_if(found.begin(), found.end(), [&](const Detection& detection) {
    return detection.marker == markers_[1].id;
  });
  ASSERT_NE(tag, found.end());
  EXPECT_EQ(tag->hamming, 1);
}

TEST_F(Markers, ThatTouchAtTheirCornersAreFoundBoth) {
  // A tag on a board whose black squares touch it, as calibration boards have them.
  markers_.resize(2);
  markers_[1].quiet_zone_cells = 0;
  GrayImage board = image();
  const ImageCorners corners = true_corners(camera_, markers_[1]);
  const int x = static_cast<int>(std::lround(corners[1].x()));
  const int y = static_cast<int>(std::lround(corners[1].y()));
  for (int i = 1; i <= 8; ++i) {
    for (int k = 1; k <= 8; ++k) board.row(y - k)[x + i] = 40;
  }
  EXPECT_GE(detector_.detect(board.view()).size(), 1U);
}

TEST(OwnDetector, InAnyPixelsOfAnySizeItEndsAndFindsLittle) {
  std::mt19937 generator(21);
  OwnDetector detector({Family::tag36h11, Family::aruco_5x5_50}, {});
  std::size_t found = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const int width = 1 + static_cast<int>(generator() % 150);
    const int height = 1 + static_cast<int>(generator() % 90);
    const int padding = static_cast<int>(generator() % 9);
    GrayImage image(width + padding, height);
    const unsigned kind = generator() % 4;
    for (auto& grey : image.pixels) {
      const unsigned value = generator();
      grey = static_cast<std::uint8_t>(kind == 0   ? value
                                       : kind == 1 ? (value % 2) * 255
                                       : kind == 2 ? (value % 16 == 0 ? 255 : 0)
                                                   : 100 + value % 40);
    }
    GrayView view = image.view();
    view.width_px = width;
    found += detector.detect(view).size();
    EXPECT_EQ(detector.failure(), "");
  }
  EXPECT_EQ(found, 0U);
}

TEST(OwnDetector, WhatCantBeSearchedIsAReason) {
  OwnDetector detector({Family::tag36h11}, {});
  EXPECT_TRUE(detector.detect({nullptr, 64, 64, 64}).empty());
  EXPECT_EQ(detector.failure(), "it has no pixels");
  GrayImage torn(64, 64, 90);
  EXPECT_TRUE(detector.detect({torn.pixels.data(), 64, 64, 63}).empty());
  EXPECT_EQ(detector.failure(), "its rows overlap");
  EXPECT_TRUE(detector.detect(GrayImage(32767, 12, 90).view()).empty());
  EXPECT_EQ(detector.failure(), "");
  EXPECT_TRUE(detector.detect(GrayImage(32768, 12, 90).view()).empty());
  EXPECT_NE(detector.failure(), "");
}

TEST(OwnDetector, VeryWideImagesAreSearched) {
  OwnDetector detector({Family::tag36h11}, {});
  EXPECT_TRUE(detector.detect(GrayImage(20000, 16, 90).view()).empty());
  EXPECT_TRUE(detector.detect(GrayImage(16, 20000, 90).view()).empty());
}

}  // namespace
}  // namespace waymark
