#include "mapbuilder/referees/detector_engine.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/aruco/dictionary.hpp>
#include <random>

#include "core/detect/image_detector.h"
#include "core/marker/marker_bits.h"
#include "mapbuilder/referees/apriltag_family.h"
#include "mapbuilder/referees/opencv_dictionary.h"
#include "tests/support/corner_trials.h"

namespace waymark {
namespace {

using testing::MarkerView;
using testing::RenderedMarker;

constexpr int kCellPx = 10;
constexpr std::array kEngines{DetectorEngine::own, DetectorEngine::opencv,
                              DetectorEngine::apriltag};

/// The engine's detector of some families.
std::unique_ptr<MarkerDetector> detector_of(DetectorEngine engine,
                                            const std::vector<Family>& families) {
  std::vector<MarkerCatalog::FamilyEntry> entries;
  for (const Family family : families) {
    entries.emplace_back().family = family;
    entries.back().default_size_m = 0.1;
  }
  auto detector = make_detector(engine, MarkerCatalog(entries), "here");
  EXPECT_TRUE(detector) << detector.error().message;
  return std::move(*detector);
}

/// A marker as the family's own library draws it, `kCellPx` per cell, on white paper.
class Drawing {
 public:
  explicit Drawing(const MarkerId& id)
      : layout_(marker_layout(id.family)),
        image_(2 * kMarginPx + layout_.all_cells() * kCellPx,
               2 * kMarginPx + layout_.all_cells() * kCellPx, 230) {
    if (apriltag_family(id.family) != nullptr) {
      draw_with_apriltag(id);
    } else if (is_in_opencv(id.family)) {
      draw_with_opencv(id);
    } else {
      draw_cells(id);
    }
  }

  [[nodiscard]] GrayView view() const { return image_.view(); }

  /// The square's corners, top-left first. The first pixel's edge lies half a pixel before its
  /// centre.
  [[nodiscard]] ImageCorners corners() const {
    const double low = kMarginPx + layout_.outside_cells() * kCellPx - 0.5;
    const double high = low + layout_.square_cells() * kCellPx;
    return {{{low, low}, {high, low}, {high, high}, {low, high}}};
  }

 private:
  static constexpr int kMarginPx = 40;

  void draw_with_opencv(const MarkerId& id) {
    const int side_px = layout_.all_cells() * kCellPx;
    cv::Mat drawing;
    cv::aruco::getPredefinedDictionary(opencv_dictionary(id.family))
        ->drawMarker(id.number, side_px, drawing, 1);
    draw([&](int x, int y) { return drawing.at<std::uint8_t>(y, x); });
  }

  void draw_with_apriltag(const MarkerId& id) {
    apriltag_family_t* family = apriltag_family(id.family)->create();
    image_u8_t* drawing = apriltag_to_image(family, static_cast<std::uint32_t>(id.number));
    const int first = (drawing->width - layout_.all_cells()) / 2;  // the white cells around
    draw([&](int x, int y) {
      return drawing->buf[(first + y / kCellPx) * drawing->stride + first + x / kCellPx];
    });
    std::free(drawing->buf);  // NOLINT: the library exports no function for it
    std::free(drawing);       // NOLINT
    apriltag_family(id.family)->destroy(family);
  }

  void draw_cells(const MarkerId& id) {
    const MarkerBits bits = marker_bits(id);
    draw([&](int x, int y) { return bits.is_white(y / kCellPx, x / kCellPx) ? 255 : 0; });
  }

  template <typename GreyAt>
  void draw(const GreyAt& grey_at) {
    for (int y = 0; y < layout_.all_cells() * kCellPx; ++y) {
      for (int x = 0; x < layout_.all_cells() * kCellPx; ++x) {
        image_.row(kMarginPx + y)[kMarginPx + x] = static_cast<std::uint8_t>(grey_at(x, y));
      }
    }
  }

  const MarkerLayout& layout_;
  GrayImage image_;
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
    const auto detector = detector_of(engine, {family});
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

TEST_F(SeveralFamilies, AllEnginesAgreeOnTags) {
  const std::vector<Family> tags{Family::tag36h11, Family::tag25h9};
  const auto own = detector_of(DetectorEngine::own, tags)->detect(image_.view());
  ASSERT_EQ(own.size(), 3U);
  for (const DetectorEngine engine : {DetectorEngine::opencv, DetectorEngine::apriltag}) {
    const auto referee = detector_of(engine, tags)->detect(image_.view());
    ASSERT_EQ(referee.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(own[i].marker, referee[i].marker);
      EXPECT_LT(largest_error_px(own[i].corners, referee[i].corners), 2);
    }
  }
}

TEST(DetectorEngine, KnowsItsFamilies) {
  EXPECT_TRUE(engine_knows(DetectorEngine::own, Family::tagcircle49h12, true));
  EXPECT_TRUE(engine_knows(DetectorEngine::opencv, Family::aruco_mip_36h12));
  EXPECT_FALSE(engine_knows(DetectorEngine::opencv, Family::tagstandard41h12));
  EXPECT_FALSE(engine_knows(DetectorEngine::opencv, Family::tag36h11, true));
  EXPECT_TRUE(engine_knows(DetectorEngine::apriltag, Family::tagstandard41h12));
  EXPECT_FALSE(engine_knows(DetectorEngine::apriltag, Family::aruco_mip_36h12));
}

TEST(DetectorEngine, AFamilyThatItDoesNotKnowIsRefused) {
  const MarkerCatalog catalog(
      {{Family::tag36h11, 0.1, {}, {}}, {Family::aruco_4x4_50, 0.1, {}, {}}});
  EXPECT_TRUE(make_detector(DetectorEngine::own, catalog, "x"));
  const auto unknown = make_detector(DetectorEngine::apriltag, catalog, "x");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().kind, ErrorKind::usage);
  EXPECT_NE(unknown.error().message.find("aruco_4x4_50"), std::string::npos);
}

TEST(DetectorEngine, RowsMayBePadded) {
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
    const auto detector = detector_of(engine, {family});
    const auto expected = detector->detect(plain);
    const auto found = detector->detect(padded);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].corners, expected[0].corners);
  }
}

TEST(DetectorEngine, TinyEmptyAndNoisyImagesHoldNothing) {
  const Family family = Family::tag36h11;
  std::mt19937 generator(3);
  GrayImage noise(320, 240);
  for (auto& grey : noise.pixels) grey = static_cast<std::uint8_t>(generator());
  for (const DetectorEngine engine : kEngines) {
    const auto detector = detector_of(engine, {family});
    for (const int size : {1, 2, 7, 12, 16, 33}) {
      EXPECT_TRUE(detector->detect(GrayImage(size, size, 128).view()).empty());
      EXPECT_TRUE(detector->detect(GrayImage(size, 200, 0).view()).empty());
    }
    EXPECT_TRUE(detector->detect(GrayView{}).empty());
    EXPECT_TRUE(detector->detect(noise.view()).empty());
  }
}

TEST(DetectorEngine, OpenCvsOwnFailuresAreHeldSilently) {
  const auto detector =
      detector_of(DetectorEngine::opencv, {Family::tag36h11, Family::aruco_4x4_50});
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
