#include "core/detect/cell_steps.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

/// A marker of 8 cells of 10 px, upright, with its top-left corner in (100, 100).
class CellsOfAMarker : public testing::TestWithParam<std::size_t> {
 protected:
  static constexpr double kCell = 10;
  const MarkerBits bits_ = marker_bits({Family::tag36h11, 3});
  const ImageCorners corners_{{{100, 100}, {180, 100}, {180, 180}, {100, 180}}};
};

TEST_P(CellsOfAMarker, LieBehindEachSideAsTheyArePrinted) {
  const std::size_t side = GetParam();
  const Eigen::Vector2d along = (corners_[(side + 1) % 4] - corners_[side]) / 80;
  const Eigen::Vector2d inward(-along.y(), along.x());
  const CellSteps cells(corners_, side, bits_);
  ASSERT_EQ(cells.cells_across(), 8);
  const auto white = [&](const Eigen::Vector2d& pixel) {
    return bits_.is_white(static_cast<int>((pixel.y() - 100) / kCell),
                          static_cast<int>((pixel.x() - 100) / kCell));
  };
  for (int column = 0; column < 8; ++column) {
    const Eigen::Vector2d at = corners_[side] + (column + 0.5) * kCell * along;
    const InwardSteps steps = cells.behind(at, inward, along, 0.5, 100);
    EXPECT_NEAR(steps.border_px, kCell, 1e-9);
    EXPECT_NEAR(steps.paper_px, kCell, 1e-9);
    double whiteness = 0;
    for (std::size_t row = 0; row < InwardSteps::kRows; ++row) {
      const double depth = kCell * static_cast<double>(row + 1);
      EXPECT_NEAR(steps.depth_px[row], depth, 1e-9);
      whiteness += steps.change[row];
      EXPECT_NEAR(whiteness, white(at + (depth + 0.5 * kCell) * inward) ? 1 : 0, 1e-6)
          << column << " " << row;
    }
  }
}

TEST_P(CellsOfAMarker, BeyondTheReachNothingChanges) {
  const std::size_t side = GetParam();
  const Eigen::Vector2d along = (corners_[(side + 1) % 4] - corners_[side]) / 80;
  const CellSteps cells(corners_, side, bits_);
  const InwardSteps steps =
      cells.behind(corners_[side] + 35 * along, {-along.y(), along.x()}, along, 0.5, 9);
  for (const double change : steps.change) EXPECT_EQ(change, 0);
}

INSTANTIATE_TEST_SUITE_P(CellSteps, CellsOfAMarker, testing::Range<std::size_t>(0, 4));

}  // namespace
}  // namespace waymark
