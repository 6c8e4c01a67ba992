#include "core/detect/own_detector.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "core/marker/marker_bits.h"
#include "core/marker/marker_outline.h"
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

TEST_F(Markers, InWindowsThatHoldThemAreFoundAsInTheWholeImage) {
  for (const double noise_grey : {2.0, 14.0}) {
    const GrayImage seen = image(noise_grey);
    const std::vector<Detection> all = detector_.detect(seen.view());
    std::vector<ImageWindow> windows;
    for (const Detection& detection : all) {
      const Eigen::Vector2d middle = centre_of(detection.corners);
      const int reach = static_cast<int>(mean_side_px(detection.corners)) + 12;
      windows.push_back({static_cast<int>(middle.x()) - reach, static_cast<int>(middle.y()) - reach,
                         2 * reach, 2 * reach});
    }
    const std::vector<Detection> found = detector_.detect(seen.view(), windows);
    ASSERT_EQ(found.size(), all.size()) << noise_grey;
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_EQ(found[i].marker, all[i].marker);
      for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_LT((found[i].corners[k] - all[i].corners[k]).norm(), 0.3);
      }
    }
  }
}

TEST_F(Markers, BesideTheWindowsAreNotLookedFor) {
  const GrayImage seen = image();
  const ImageWindow window{0, 0, 200, 200};
  EXPECT_EQ(detector_.detect(seen.view(), {&window, 1}).size(), 1U);
  const ImageWindow outside{900, -50, 20, 2000};
  EXPECT_TRUE(detector_.detect(seen.view(), {&outside, 1}).empty());
  EXPECT_EQ(detector_.failure(), "");
}

TEST_F(Markers, InOtherWindowsOfEveryImageNothingIsAllocated) {
  const GrayImage seen = image();
  const auto look = [&](int step) {
    const std::array<ImageWindow, 2> windows{
        {{step, step, 120 + step, 130}, {300 - step, 250, 150, 140 + 2 * step}}};
    (void)detector_.detect(seen.view(), windows);
  };
  (void)detector_.detect(seen.view());
  for (int step = 0; step < 60; ++step) look(step);
  const long before = testing::allocations();
  for (int step = 0; step < 60; ++step) look(step);
  EXPECT_EQ(testing::allocations() - before, 0);
}

/// A family's marker, printed as the family draws it or inverted.
class EveryPrint : public ::testing::TestWithParam<std::tuple<Family, bool>> {};

TEST_P(EveryPrint, IsFoundUprightAndOnlyAsItIsPrinted) {
  const auto [family, inverted] = GetParam();
  const CameraModel camera = testing::trial_camera();
  RenderedMarker marker;
  marker.id = {family, traits(family).id_count / 2};
  if (inverted) std::swap(marker.black, marker.white);
  const double side_px = 6.0 * marker_layout(family).square_cells();
  marker.cam_from_marker =
      pose_seen_as(camera, MarkerView{{160, 160}, side_px, 0.5, 1.0, 0.7}, marker.size_m);
  testing::RenderOptions options;
  if (inverted) options.background = 60;
  const GrayImage image = testing::render_markers(camera, {&marker, 1}, options);
  DetectorOptions wanted;
  if (inverted) wanted.inverted = {family};
  const std::vector<Detection> found = OwnDetector({family}, wanted).detect(image.view());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].marker, marker.id);
  EXPECT_EQ(found[0].hamming, 0);
  const ImageCorners truth = true_corners(camera, marker);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((found[0].corners[k] - truth[k]).norm(), 1.0);
  DetectorOptions other;
  if (!inverted) other.inverted = {family};
  EXPECT_TRUE(OwnDetector({family}, other).detect(image.view()).empty());
}

std::vector<Family> families() {
  std::vector<Family> all;
  for (const FamilyTraits& family : all_families()) all.push_back(family.family);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Families, EveryPrint,
                         ::testing::Combine(::testing::ValuesIn(families()), ::testing::Bool()),
                         [](const auto& info) {
                           return std::string(name_of(std::get<0>(info.param))) +
                                  (std::get<1>(info.param) ? "_inverted" : "");
                         });

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
