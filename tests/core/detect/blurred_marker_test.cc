#include "core/detect/blurred_marker.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string_view>

#include "tests/support/numeric_jacobian.h"

namespace waymark {
namespace {

/// Two black cells, a white one and a black one in each row but the first, which is black.
MarkerBits striped() {
  static const std::array<std::string_view, 4> kPicture = {"....", "..#.", "..#.", "..#."};
  static const MarkerLayout kLayout(kPicture, 4);
  MarkerBits bits;
  bits.layout = &kLayout;
  bits.cells = 4;
  for (int row = 1; row < 4; ++row) bits.white[bits.index(row, 2)] = 1;
  return bits;
}

double white_at(const MarkerBits& bits, double x, double y) {
  const int column = static_cast<int>(std::floor(x));
  const int row = static_cast<int>(std::floor(y));
  if (column < 0 || row < 0 || column >= bits.cells || row >= bits.cells) return 1;
  return bits.is_white(row, column) ? 1 : 0;
}

/// How much of cell `cell` a pixel sees along an axis, by brute force: its square and a Gaussian.
double share_of_cell(const AxisView& axis, int cell) {
  constexpr int kSteps = 4000;
  constexpr double kReach_px = 5;
  const auto below = [&](double px) {
    return 0.5 * std::erfc(-px / (axis.blur_px * std::sqrt(2.0)));
  };
  double sum = 0;
  double total = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double px = kReach_px * ((2 * i + 1.0) / kSteps - 1);
    const double weight = below(px + 0.5) - below(px - 0.5);
    total += weight;
    if (std::floor(axis.place + px * axis.cells_per_px) == cell) sum += weight;
  }
  return sum / total;
}

double integrated_white(const MarkerBits& bits, const AxisView& x, const AxisView& y) {
  double black = 0;
  for (int row = 0; row < bits.cells; ++row) {
    for (int column = 0; column < bits.cells; ++column) {
      if (!bits.is_white(row, column)) black += share_of_cell(x, column) * share_of_cell(y, row);
    }
  }
  return 1 - black;
}

TEST(BlurredMarker, DeepInACellIsThatCell) {
  const MarkerBits bits = striped();
  const BlurredMarker marker(bits);
  for (const auto& [x, y] :
       {std::pair{-0.5, 1.5}, {0.5, 0.5}, {2.5, 2.5}, {3.5, 2.5}, {2.5, 4.5}}) {
    EXPECT_NEAR(marker.at({x, 0.02, 0.5}, {y, 0.02, 0.5}, 0.1).value, white_at(bits, x, y), 1e-9);
  }
}

TEST(BlurredMarker, AlongAnEdgeIsTheBlurOfLensAndPixel) {
  const MarkerBits bits = striped();
  const BlurredMarker marker(bits);
  for (int i = 0; i < 33; ++i) {
    const double place = 1.2 + 0.07 * i;
    const AxisView x{place, 0.2, 0.6};
    const AxisView y{2.5, 0.05, 0.6};
    EXPECT_NEAR(marker.at(x, y, 0).value, integrated_white(bits, x, y), 1e-3) << place;
  }
}

TEST(BlurredMarker, WhereRowsAndColumnsMeetIsTheBlurToo) {
  const MarkerBits bits = striped();
  const BlurredMarker marker(bits);
  for (int i = 0; i < 37; ++i) {
    const double place = -0.4 + 0.13 * i;
    const AxisView x{place, 0.15, 0.5};
    const AxisView y{1 + 0.3 * std::sin(place), 0.15, 0.5};
    EXPECT_NEAR(marker.at(x, y, 0).value, integrated_white(bits, x, y), 1e-3) << place;
  }
}

TEST(BlurredMarker, GrownWhiteMovesEdgesIntoTheBlack) {
  const BlurredMarker marker(striped());
  constexpr double kGrowth_px = 0.3;
  constexpr double kCells_per_px = 0.1;
  // The left side: paper is white up to 0, and 0.3 px further when grown.
  const AxisView y{0.5, kCells_per_px, 0.5};
  EXPECT_NEAR(marker.at({kGrowth_px * kCells_per_px, kCells_per_px, 0.5}, y, kGrowth_px).value,
              marker.at({0, kCells_per_px, 0.5}, y, 0).value, 1e-6);
  // The white cell's left edge at 2 moves left.
  const AxisView in_row{2.5, 0.05, 0.5};
  EXPECT_NEAR(
      marker.at({2 - kGrowth_px * kCells_per_px, kCells_per_px, 0.5}, in_row, kGrowth_px).value,
      marker.at({2, kCells_per_px, 0.5}, in_row, 0).value, 1e-6);
}

TEST(BlurredMarker, DerivativesAreThoseOfDifferences) {
  const BlurredMarker marker(striped());
  for (int i = 0; i < 46; ++i) {
    const double place = -0.5 + 0.11 * i;
    const double row = 2 + 1.7 * std::sin(3 * place);
    const auto value = [&](const Eigen::Matrix<double, 5, 1>& d) {
      return Eigen::Matrix<double, 1, 1>(
          marker.at({place + d[0], 0.12, 0.5 + d[2]}, {row + d[1], 0.15, 0.7 + d[3]}, 0.1 + d[4])
              .value);
    };
    const auto numeric = test::numeric_jacobian<1, 5>(value, 1e-3);
    const Whiteness w = marker.at({place, 0.12, 0.5}, {row, 0.15, 0.7}, 0.1);
    Eigen::Matrix<double, 1, 5> analytic;
    analytic << w.d_place.transpose(), w.d_blur.transpose(), w.d_growth;
    // The table of the normal distribution is a polygon.
    EXPECT_LT((numeric - analytic).norm(), 0.02) << place;
  }
}

TEST(BlurredMarker, EdgesAreNearWhereColoursMeetWithinReach) {
  const BlurredMarker marker(striped());
  // The left side of the black, and a place of its border, two fifths of a cell from it.
  EXPECT_TRUE(marker.has_edge_near({0.1, 2.5}, 0.3));
  EXPECT_TRUE(marker.has_edge_near({-0.1, 2.5}, 0.3));
  EXPECT_FALSE(marker.has_edge_near({0.4, 0.5}, 0.3));
  EXPECT_TRUE(marker.has_edge_near({0.4, 0.5}, 0.5));
  // Beyond the ring of paper there is nothing but paper.
  EXPECT_FALSE(marker.has_edge_near({-3, -3}, 0.5));
}

}  // namespace
}  // namespace waymark
