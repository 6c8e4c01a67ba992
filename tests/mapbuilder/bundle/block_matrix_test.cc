#include "mapbuilder/bundle/block_matrix.h"

#include <gtest/gtest.h>

#include <vector>

namespace waymark {
namespace {

TEST(BlockPattern, OfGroupsHasABlockWhereverTwoMeet) {
  const BlockPattern pattern = pattern_of_groups(5, {{0, 2}, {2, 3}, {0, 2}});
  EXPECT_EQ(pattern.columns(), 5);
  EXPECT_EQ(pattern.first, (std::vector<int>{0, 2, 3, 5, 6, 7}));
  EXPECT_EQ(pattern.rows, (std::vector<int>{0, 2, 1, 2, 3, 3, 4}));
  EXPECT_EQ(pattern.blocks(), 7U);
  for (int column = 0; column < 5; ++column) {
    EXPECT_EQ(pattern.find(column, column), pattern.first[static_cast<std::size_t>(column)]);
  }
  EXPECT_EQ(pattern.find(2, 0), 1);
  EXPECT_EQ(pattern.find(3, 0), -1);
  EXPECT_EQ(pattern.find(4, 3), -1);
}

TEST(FixBlock, LeavesTheUnitMatrixInItsRowsAndColumns) {
  BlockMatrix matrix{pattern_of_groups(3, {{0, 1}, {1, 2}}), {}};
  matrix.blocks.assign(matrix.pattern.blocks(), Matrix6d::Constant(7));
  fix_block(matrix, 1);
  const auto block = [&](int row, int column) {
    return matrix.blocks[static_cast<std::size_t>(matrix.pattern.find(row, column))];
  };
  EXPECT_EQ(block(1, 1), Matrix6d::Identity());
  EXPECT_EQ(block(1, 0), Matrix6d::Zero());
  EXPECT_EQ(block(2, 1), Matrix6d::Zero());
  EXPECT_EQ(block(0, 0), Matrix6d::Constant(7));
  EXPECT_EQ(block(2, 2), Matrix6d::Constant(7));
}

}  // namespace
}  // namespace waymark
