#include "core/detect/marker_detector.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <opencv2/aruco/dictionary.hpp>
#include <random>
#include <stdexcept>

#include "core/detect/aruco_detector.h"
#include "core/marker/marker_bits.h"
#include "core/marker/opencv_dictionary.h"
#include "tests/support/corner_trials.h"

namespace waymark {
namespace {

using testing::MarkerView;
using testing::RenderedMarker;

constexpr int kCellPx = 10;
constexpr std::array kEngines{DetectorEngine::own, DetectorEngine::opencv,
                              DetectorEngine::apriltag};

/// A marker as the family's own generator draws it, `kCellPx` per cell, on white paper.
class Drawing {
 public:
  explicit Drawing(const MarkerId& id) {
    image_ = GrayImage(kMarginPx * 2 + 9 * kCellPx, kMarginPx * 2 + 9 * kCellPx, 230);
    if (id.family >= Family::tag16h5) {
      draw_with_apriltag(id);
    } else {
      draw_with_opencv(id);
    }
  }

  [[nodiscard]] GrayView view() const { return image_.view(); }

  /// The drawing's corners, top-left first. The first black pixel's edge lies half a pixel before
  /// its centre.
  [[nodiscard]] ImageCorners corners() const {
    const double low = kMarginPx - 0.5;
    const double high = low + side_px_;
    return {{{low, low}, {high, low}, {high, high}, {low, high}}};
  }

 private:
  static constexpr int kMarginPx = 40;

  void draw_with_opencv(const MarkerId& id) {
    side_px_ = (traits(id.family).code_cells + 2) * kCellPx;
    cv::Mat drawing;
    cv::aruco::getPredefinedDictionary(opencv_dictionary(id.family))
        ->drawMarker(id.number, side_px_, drawing, 1);
    for (int y = 0; y < side_px_; ++y) {
      for (int x = 0; x < side_px_; ++x) {
        image_.row(kMarginPx + y)[kMarginPx + x] = drawing.at<std::uint8_t>(y, x);
      }
    }
  }

  void draw_with_apriltag(const MarkerId& id) {
    struct Generator {
      apriltag_family_t* (*create)();
      void (*destroy)(apriltag_family_t*);
    };
    const Generator generator =
        id.family == Family::tag16h5    ? Generator{tag16h5_create, tag16h5_destroy}
        : id.family == Family::tag25h9  ? Generator{tag25h9_create, tag25h9_destroy}
        : id.family == Family::tag36h10 ? Generator{tag36h10_create, tag36h10_destroy}
                                        : Generator{tag36h11_create, tag36h11_destroy};
    apriltag_family_t* family = generator.create();
    image_u8_t* drawing = apriltag_to_image(family, id.number);
    const int cells = family->width_at_border;
    const int first = (drawing->width - cells) / 2;  // the white cells around
    side_px_ = cells * kCellPx;
    for (int y = 0; y < side_px_; ++y) {
      for (int x = 0; x < side_px_; ++x) {
        image_.row(kMarginPx + y)[kMarginPx + x] =
            drawing->buf[(first + y / kCellPx) * drawing->stride + first + x / kCellPx];
      }
    }
    std::free(drawing->buf);  // NOLINT: the library exports no function for it
    std::free(drawing);       // NOLINT
    generator.destroy(family);
  }

  GrayImage image_;
  int side_px_ = 0;
};

double largest_error_px(const ImageCorners& a, const ImageCorners& b) {
  double largest = 0;
  for (std::size_t i = 0; i < 4; ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

class EveryFamily : public ::testing::TestWithParam<Family> {};

TEST_P(EveryFamily, UprightAsItsOwnGeneratorDrawsItTheFirstCornerIsTopLeft) {
  const Family family = GetParam();
  const int last = traits(family).id_count - 1;
  for (const DetectorEngine engine : kEngines) {
    if (!engine_knows(engine, family)) continue;
    const auto detector = make_detector({&family, 1}, {.engine = engine});
    for (const int number : {1, last / 2, last}) {
      const Drawing drawing({family, number});
      const auto found = detector->detect(drawing.view());
      ASSERT_EQ(found.size(), 1U) << name_of(family) << " " << number;
      EXPECT_EQ(found[0].marker, (MarkerId{family, number}));
      EXPECT_EQ(found[0].hamming, 0);
      EXPECT_LT(largest_error_px(found[0].corners, drawing.corners()), 1.5)
          << name_of(family) << " " << number << " engine " << static_cast<int>(engine);
    }
  }
}

TEST_P(EveryFamily, CellsAreThoseOfItsOwnGenerator) {
  const Family family = GetParam();
  const MarkerId id{family, traits(family).id_count / 3};
  const Drawing drawing(id);
  const MarkerBits bits = marker_bits(id);
  for (int row = 0; row < bits.cells; ++row) {
    for (int column = 0; column < bits.cells; ++column) {
      const Eigen::Vector2d middle =
          drawing.corners()[0] + kCellPx * Eigen::Vector2d(column + 0.5, row + 0.5);
      const int grey =
          drawing.view().row(static_cast<int>(middle.y()))[static_cast<int>(middle.x())];
      EXPECT_EQ(grey > 127, bits.is_white(row, column)) << row << " " << column;
    }
  }
}

std::vector<Family> families() {
  std::vector<Family> all;
  for (const FamilyTraits& family : all_families()) all.push_back(family.family);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Families, EveryFamily, ::testing::ValuesIn(families()),
                         [](const auto& info) { return std::string(name_of(info.param)); });

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

TEST_F(SeveralFamilies, AllEnginesAgreeOnTags) {
  const std::vector<Family> tags{Family::tag36h11, Family::tag25h9};
  const auto own = make_detector(tags, {.engine = DetectorEngine::own})->detect(image_.view());
  ASSERT_EQ(own.size(), 3U);
  for (const DetectorEngine engine : {DetectorEngine::opencv, DetectorEngine::apriltag}) {
    const auto referee = make_detector(tags, {.engine = engine})->detect(image_.view());
    ASSERT_EQ(referee.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(own[i].marker, referee[i].marker);
      EXPECT_LT(largest_error_px(own[i].corners, referee[i].corners), 2);
    }
  }
}

TEST_F(SeveralFamilies, OpencvThreadsDoNotChangeTheResult) {
  const auto detector = make_detector(families(), {.engine = DetectorEngine::opencv});
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const auto one = detector->detect(image_.view());
  cv::setNumThreads(4);
  const auto four = detector->detect(image_.view());
  cv::setNumThreads(threads);
  ASSERT_EQ(one.size(), four.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].marker, four[i].marker);
    EXPECT_EQ(one[i].corners, four[i].corners);
  }
}

TEST(MarkerDetector, RowsMayBePadded) {
  const Drawing drawing({Family::tag36h11, 11});
  const GrayView plain = drawing.view();
  GrayImage wide(plain.width_px + 13, plain.height_px, 77);
  for (int y = 0; y < plain.height_px; ++y) {
    std::copy(plain.row(y), plain.row(y) + plain.width_px, wide.row(y));
  }
  GrayView padded = wide.view();
  padded.width_px = plain.width_px;
  const Family family = Family::tag36h11;
  for (const DetectorEngine engine : kEngines) {
    const auto detector = make_detector({&family, 1}, {.engine = engine});
    const auto expected = detector->detect(plain);
    const auto found = detector->detect(padded);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].corners, expected[0].corners);
  }
}

TEST(MarkerDetector, TinyEmptyAndNoisyImagesHoldNothing) {
  const Family family = Family::tag36h11;
  std::mt19937 generator(3);
  GrayImage noise(320, 240);
  for (auto& grey : noise.pixels) grey = static_cast<std::uint8_t>(generator());
  for (const DetectorEngine engine : kEngines) {
    const auto detector = make_detector({&family, 1}, {.engine = engine});
    for (const int size : {1, 2, 7, 12, 16, 33}) {
      EXPECT_TRUE(detector->detect(GrayImage(size, size, 128).view()).empty());
      EXPECT_TRUE(detector->detect(GrayImage(size, 200, 0).view()).empty());
    }
    EXPECT_TRUE(detector->detect(GrayView{}).empty());
    EXPECT_TRUE(detector->detect(noise.view()).empty());
  }
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

TEST(CorrectableBits, StaysWithinDistanceAndChance) {
  EXPECT_EQ(correctable_bits(Family::tag36h11), 3);
  EXPECT_EQ(correctable_bits(Family::aruco_4x4_1000), 0);
  EXPECT_EQ(correctable_bits(Family::aruco_original), 0);
  EXPECT_GE(correctable_bits(Family::aruco_6x6_250), 3);
  for (const FamilyTraits& family : all_families()) {
    EXPECT_LE(correctable_bits(family.family), 9) << family.name;
  }
}

/// A library that fails every other time.
template <typename Thrown>
class FailingDetector final : public MarkerDetector {
 public:
  explicit FailingDetector(Thrown thrown) : thrown_(std::move(thrown)) {}

 private:
  const std::vector<Detection>& find(const GrayView&) override {
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
  expect_held(cv::Exception(cv::Error::StsAssert, "assertion failed\n", "f", "f.cpp", 7),
              "assertion failed");
  expect_held(std::runtime_error("two\nlines"), "two");
  expect_held(std::bad_alloc(), "bad_alloc");
  expect_held(42, "the detector's library failed");
}

TEST(MarkerDetector, OpenCvsOwnFailuresAreHeldSilently) {
  const std::vector<Family> families{Family::tag36h11, Family::aruco_4x4_50};
  const auto detector = make_detector(families, {.engine = DetectorEngine::opencv});
  ::testing::internal::CaptureStderr();
  const GrayView without_pixels{nullptr, 64, 64, 64};
  EXPECT_TRUE(detector->detect(without_pixels).empty());
  EXPECT_NE(detector->failure(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  const GrayImage image(64, 64, 200);
  EXPECT_TRUE(detector->detect(image.view()).empty());
  EXPECT_EQ(detector->failure(), "");
}

}  // namespace
}  // namespace waymark
