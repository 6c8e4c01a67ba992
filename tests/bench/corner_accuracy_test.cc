#include "bench/corner_accuracy.h"

#include <gtest/gtest.h>

#include <random>

namespace waymark {
namespace {

/// An oblique view of a marker, clockwise in the image from its top left corner on.
const ImageCorners kOblique = {{{100, 120}, {180, 131}, {171, 206}, {96, 188}}};

ImageCorners noisy(const ImageCorners& corners, double sigma_px, std::mt19937_64& engine) {
  std::normal_distribution<double> normal(0, sigma_px);
  ImageCorners moved = corners;
  for (Eigen::Vector2d& corner : moved) corner += Eigen::Vector2d(normal(engine), normal(engine));
  return moved;
}

TEST(CornerAccuracy, MovedEdgesLieAsFarOutsideAsTheyWereMoved) {
  for (const double offset_px : {-0.4, 0.0, 0.25}) {
    const ImageCorners moved = with_edges_moved(kOblique, offset_px);
    EXPECT_NEAR(edge_offset_px({moved, kOblique}), offset_px, 1e-12);
    EXPECT_EQ(area_px2(moved) > area_px2(kOblique), offset_px > 0);
  }
}

TEST(CornerAccuracy, AShiftOfTheWholeMarkerIsNoEdgeBias) {
  ImageCorners shifted = kOblique;
  for (Eigen::Vector2d& corner : shifted) corner += Eigen::Vector2d(0.3, -0.2);
  const CornerPair marker{shifted, kOblique};
  EXPECT_NEAR(edge_offset_px(marker), 0.0, 1e-12);
  EXPECT_NEAR(corner_accuracy({&marker, 1}).rms_px, std::hypot(0.3, 0.2), 1e-12);
}

TEST(CornerAccuracy, BiasAndSigmaAreToldApart) {
  std::mt19937_64 engine(3);
  std::vector<CornerPair> markers;
  for (int i = 0; i < 4000; ++i) {
    markers.push_back({noisy(with_edges_moved(kOblique, 0.05), 0.08, engine), kOblique});
  }
  const CornerAccuracy accuracy = corner_accuracy(markers);
  EXPECT_NEAR(accuracy.edge_bias_px, 0.05, 0.002);
  EXPECT_NEAR(accuracy.sigma_px, 0.08, 0.001);
  EXPECT_GT(accuracy.rms_px, accuracy.sigma_px * std::sqrt(2.0));
}

TEST(CornerAccuracy, WithoutMarkersThereIsNothingToTell) {
  EXPECT_EQ(corner_accuracy({}).rms_px, 0.0);
}

}  // namespace
}  // namespace waymark
