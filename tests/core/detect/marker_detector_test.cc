#include "core/detect/marker_detector.h"

#include <gtest/gtest.h>

#include <array>
#include <new>
#include <stdexcept>

#include "tests/support/corner_trials.h"

namespace waymark {
namespace {

using testing::MarkerView;
using testing::RenderedMarker;

/// A camera that sees six markers of three families side by side.
class SeveralFamilies : public ::testing::Test {
 protected:
  SeveralFamilies() {
    constexpr std::array kIds{
        MarkerId{Family::tag36h11, 3},        MarkerId{Family::tag36h11, 500},
        MarkerId{Family::aruco_4x4_50, 7},    MarkerId{Family::aruco_4x4_50, 7},
        MarkerId{Family::aruco_original, 99}, MarkerId{Family::tag25h9, 30}};
    for (std::size_t i = 0; i < kIds.size(); ++i) {
      RenderedMarker marker;
      marker.id = kIds[i];
      const double x = 120 + 200 * static_cast<double>(i % 3);
      const double y = 120 + 220 * static_cast<double>(i / 3);
      marker.cam_from_marker = pose_seen_as(
          camera_, MarkerView{{x, y}, 80, 0.5, 1.0 * static_cast<double>(i), 0.7}, marker.size_m);
      markers_.push_back(marker);
    }
    image_ = testing::render_markers(camera_, markers_, {});
  }

  CameraModel camera_ = *CameraModel::create({640, 480, 600, 600, 319.5, 239.5});
  std::vector<RenderedMarker> markers_;
  GrayImage image_;
};

TEST_F(SeveralFamilies, AreAllFoundInOrder) {
  const std::vector<Family> all{Family::aruco_original, Family::tag36h11, Family::aruco_4x4_50,
                                Family::tag25h9, Family::tag36h11};
  const auto found = make_detector(all)->detect(image_.view());
  ASSERT_EQ(found.size(), 6U);
  EXPECT_EQ(found[0].marker, (MarkerId{Family::aruco_4x4_50, 7}));
  EXPECT_EQ(found[1].marker, (MarkerId{Family::aruco_4x4_50, 7})) << "the same id twice stays";
  EXPECT_LT(found[0].corners[0].x(), found[1].corners[0].x());
  EXPECT_EQ(found[2].marker, (MarkerId{Family::aruco_original, 99}));
  EXPECT_EQ(found[3].marker, (MarkerId{Family::tag25h9, 30}));
  EXPECT_EQ(found[4].marker, (MarkerId{Family::tag36h11, 3}));
  EXPECT_EQ(found[5].marker, (MarkerId{Family::tag36h11, 500}));
}

TEST(MarkerDetector, SmallMarkersAreFoundDownToTheStatedSide) {
  const CameraModel camera = testing::trial_camera();
  const Family family = Family::aruco_4x4_50;
  RenderedMarker marker;
  marker.id = {family, 5};
  marker.quiet_zone_cells = 2;
  const auto found_at = [&](double side_px, double min_side_px) {
    marker.cam_from_marker =
        pose_seen_as(camera, MarkerView{{160, 160}, side_px, 0.2, 0, 0.4}, marker.size_m);
    const GrayImage image = testing::render_markers(camera, {&marker, 1}, {});
    return make_detector({&family, 1}, {min_side_px})->detect(image.view()).size();
  };
  EXPECT_EQ(found_at(24, 20), 1U);
  EXPECT_EQ(found_at(24, 30), 0U);
}

/// A library that fails every other time.
template <typename Thrown>
class FailingDetector final : public MarkerDetector {
 public:
  explicit FailingDetector(Thrown thrown) : thrown_(std::move(thrown)) {}

 private:
  const std::vector<Detection>& find(const GrayView&, std::span<const ImageWindow>) override {
    if (fails_ = !fails_; fails_) throw thrown_;
    return found_;
  }

  Thrown thrown_;
  bool fails_ = false;
  std::vector<Detection> found_{Detection{}};
};

template <typename Thrown>
void expect_held(const Thrown& thrown, const std::string& reason) {
  FailingDetector<Thrown> detector(thrown);
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(detector.detect({}).empty());
    EXPECT_NE(detector.failure().find(reason), std::string::npos) << detector.failure();
    EXPECT_EQ(detector.failure().find('\n'), std::string::npos);
    EXPECT_EQ(detector.detect({}).size(), 1U);
    EXPECT_EQ(detector.failure(), "");
  }
}

TEST(MarkerDetector, WhatALibraryThrowsIsAReasonNotTheEnd) {
  expect_held(std::runtime_error("two\nlines"), "two");
  expect_held(std::bad_alloc(), "bad_alloc");
  expect_held(42, "the detector's library failed");
}

TEST(MarkerDetector, OrdersWhatItFinds) {
  class Unordered final : public MarkerDetector {
    const std::vector<Detection>& find(const GrayView&, std::span<const ImageWindow>) override {
      return found_;
    }
    std::vector<Detection> found_ = [] {
      std::vector<Detection> found(3);
      found[0].marker = {Family::tag36h11, 2};
      found[1].marker = {Family::tag36h11, 1};
      found[2].marker = {Family::aruco_4x4_50, 9};
      return found;
    }();
  } detector;
  const auto& found = detector.detect({});
  EXPECT_EQ(found[0].marker.family, Family::aruco_4x4_50);
  EXPECT_EQ(found[1].marker.number, 1);
  EXPECT_EQ(found[2].marker.number, 2);
}

}  // namespace
}  // namespace waymark
