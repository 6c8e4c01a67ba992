#include "core/detect/image_detector.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/marker/marker_outline.h"
#include "tests/support/corner_trials.h"
#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

using testing::MarkerView;
using testing::RenderedMarker;

MarkerCatalog catalog_of(Family family, std::set<int> ignored = {}) {
  return MarkerCatalog({{family, 0.3, {}, std::move(ignored)}});
}

/// Four markers around the middle of the image.
class FourMarkers : public ::testing::Test {
 protected:
  FourMarkers() {
    for (int i = 0; i < 4; ++i) {
      RenderedMarker marker;
      marker.id = {Family::aruco_4x4_1000, 100 + i};
      marker.cam_from_marker = pose_seen_as(
          camera_,
          MarkerView{{180.0 + 280 * (i % 2), 130.0 + 230 * (i / 2)}, 90, 0.6, 1.0 * i, 0.4 * i},
          marker.size_m);
      markers_.push_back(marker);
    }
    render();
  }

  void render() { image_ = testing::render_markers(camera_, markers_, {}); }

  CameraModel camera_ = *CameraModel::create(
      {640, 480, 600, 600, 319.5, 239.5, Distortion::radtan, {-0.2, 0.04, 0, 0}});
  std::vector<RenderedMarker> markers_;
  GrayImage image_;
};

TEST_F(FourMarkers, AreKeptWithExactCornersAndCovariances) {
  ImageDetector detector(catalog_of(Family::aruco_4x4_1000));
  const FoundMarkers found = detector.detect(image_.view(), camera_);
  ASSERT_EQ(found.detections.size(), 4U);
  EXPECT_EQ(found.counts.kept, 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const Detection& detection = found.detections[i];
    EXPECT_EQ(detection.marker, markers_[i].id);
    EXPECT_EQ(detection.hamming, 0);
    ASSERT_TRUE(detection.covariances);
    const ImageCorners truth = true_corners(camera_, markers_[i]);
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector2d error = detection.corners[k] - truth[k];
      EXPECT_LT(error.norm(), 0.08);
      const double sigma_px = std::sqrt((*detection.covariances)[k].trace() / 2);
      EXPECT_GT(sigma_px, 0.002);
      EXPECT_LT(sigma_px, 0.05);
    }
  }
}

TEST_F(FourMarkers, CornersMoveOutwardByTheEdgeBias) {
  ImageDetector detector(catalog_of(Family::aruco_4x4_1000));
  const auto plain = detector.detect(image_.view(), camera_).detections;
  const auto moved = detector.detect(image_.view(), camera_, {}, 0.25).detections;
  ASSERT_EQ(moved.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(inset_px(plain[i].corners, moved[i].corners), 0.25, 1e-3);
  }
}

TEST_F(FourMarkers, IgnoredIdsAreCountedAndLeftOut) {
  ImageDetector detector(catalog_of(Family::aruco_4x4_1000, {101, 103}));
  const FoundMarkers found = detector.detect(image_.view(), camera_);
  EXPECT_EQ(found.counts.found, 4);
  EXPECT_EQ(found.counts.unknown, 2);
  ASSERT_EQ(found.detections.size(), 2U);
  EXPECT_EQ(found.detections[1].marker.number, 102);
}

TEST_F(FourMarkers, TheResultDoesNotDependOnWhatWasSeenBefore) {
  ImageDetector fresh(catalog_of(Family::aruco_4x4_1000));
  ImageDetector used(catalog_of(Family::aruco_4x4_1000));
  const GrayImage blank(640, 480, 90);
  EXPECT_TRUE(used.detect(blank.view(), camera_).detections.empty());
  (void)used.detect(image_.view(), camera_);
  const auto a = fresh.detect(image_.view(), camera_).detections;
  const auto b = used.detect(image_.view(), camera_).detections;
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].corners, b[i].corners);
}

TEST_F(FourMarkers, AMarkerWithoutPaperOnOneSideIsDroppedAndCounted) {
  // Black paint over the paper left of the first marker's left side: the quad is still found by
  // its contour or not at all, but it never gets corners on the paint's edge.
  const ImageCorners truth = true_corners(camera_, markers_[0]);
  for (int y = 0; y < 260; ++y) {
    for (int x = 0; x < static_cast<int>(truth[0].x()) + 12; ++x) image_.row(y)[x] = 40;
  }
  ImageDetector detector(catalog_of(Family::aruco_4x4_1000));
  const FoundMarkers found = detector.detect(image_.view(), camera_);
  for (const Detection& detection : found.detections) EXPECT_NE(detection.marker.number, 100);
  EXPECT_EQ(found.counts.kept, 3);
}

TEST_F(FourMarkers, AMarkerCutByTheImageIsDropped) {
  markers_.resize(1);
  const double side = mean_side_px(true_corners(camera_, markers_[0]));
  markers_[0].cam_from_marker =
      pose_seen_as(camera_, MarkerView{{0.3 * side, 240}, side, 0.1, 0, 0}, 1.0);
  render();
  ImageDetector detector(catalog_of(Family::aruco_4x4_1000));
  EXPECT_TRUE(detector.detect(image_.view(), camera_).detections.empty());
}

TEST(ImageDetector, ASquareReadAsTwoMarkersIsAmbiguous) {
  // Ids 0–49 of the 50 and the 1000 dictionaries look alike: with both in the catalog nobody can
  // tell them apart; the catalog's own list of ids can.
  const CameraModel camera = testing::trial_camera();
  RenderedMarker marker;
  marker.id = {Family::aruco_4x4_50, 12};
  marker.cam_from_marker = pose_seen_as(camera, MarkerView{{160, 160}, 90, 0.4, 0, 0.2}, 1.0);
  const GrayImage image = testing::render_markers(camera, {&marker, 1}, {});

  ImageDetector both(
      MarkerCatalog({{Family::aruco_4x4_50, 0.3, {}, {}}, {Family::aruco_4x4_1000, 0.3, {}, {}}}));
  const FoundMarkers unclear = both.detect(image.view(), camera);
  EXPECT_TRUE(unclear.detections.empty());
  EXPECT_EQ(unclear.counts.ambiguous, 2);

  ImageDetector listed(MarkerCatalog(
      {{Family::aruco_4x4_50, 0.3, {}, {}}, {Family::aruco_4x4_1000, 0.3, {}, {12}}}));
  const FoundMarkers clear = listed.detect(image.view(), camera);
  ASSERT_EQ(clear.detections.size(), 1U);
  EXPECT_EQ(clear.detections[0].marker, marker.id);
}

TEST(ImageDetector, CountsAddUp) {
  DetectionCounts sum{1, 2, 3, 4, 5, 6};
  sum += DetectionCounts{10, 20, 30, 40, 50, 60};
  EXPECT_EQ(sum.found, 11);
  EXPECT_EQ(sum.unknown, 22);
  EXPECT_EQ(sum.unrefined, 33);
  EXPECT_EQ(sum.misread, 44);
  EXPECT_EQ(sum.ambiguous, 55);
  EXPECT_EQ(sum.kept, 66);
}

TEST_F(FourMarkers, TellASaturatedOneHowBlurredItIs) {
  RenderedMarker& bright = markers_.back();
  bright.white = 330;  // clipped at 255
  ImageDetector beside_others(catalog_of(Family::aruco_4x4_1000));
  ImageDetector alone(catalog_of(Family::aruco_4x4_1000, {100, 101, 102}));
  const ImageCorners truth = true_corners(camera_, bright);
  const auto squared_error = [&](ImageDetector& detector) {
    const auto& found = detector.detect(image_.view(), camera_).detections;
    EXPECT_FALSE(found.empty());
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) sum += (found.back().corners[k] - truth[k]).squaredNorm();
    return sum;
  };
  double with_others = 0;
  double by_itself = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    image_ = testing::render_markers(camera_, markers_, {.seed = seed});
    with_others += squared_error(beside_others);
    by_itself += squared_error(alone);
  }
  EXPECT_LT(with_others, 0.8 * by_itself);
}

TEST(ImageDetectorOptions, AreHeldToTheirRanges) {
  expect_ranges<DetectorOptions>({ranged("min_side_px", &DetectorOptions::min_side_px, {8, 1000})});
  expect_ranges<RefineOptions>(
      {ranged("max_shift_px", &RefineOptions::max_shift_px, {1, 14}),
       ranged("min_contrast_grey", &RefineOptions::min_contrast_grey, {1, 255}),
       ranged("max_columns", &RefineOptions::max_columns, {8, 1000}),
       ranged("model_sigma_px", &RefineOptions::model_sigma_px, {0, 1})});
  ImageDetectorOptions options;
  options.detector.min_side_px = 7;
  EXPECT_EQ(options.check().error().message,
            "detector.min_side_px is 7; it must be from 8 to 1000");
  options = {};
  options.refine.max_columns = 7;
  EXPECT_EQ(options.check().error().message, "refine.max_columns is 7; it must be from 8 to 1000");
}

}  // namespace
}  // namespace waymark
