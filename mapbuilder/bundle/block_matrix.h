#pragma once

#include <vector>

#include "core/geometry/rigid3.h"

namespace waymark {

/// Where the 6×6 blocks of a symmetric block matrix's lower half stand, column by column. Every
/// column begins with its diagonal block.
struct BlockPattern {
  std::vector<int> first;  ///< per column its first block; one more entry: the number of blocks
  std::vector<int> rows;   ///< per block, rising within a column

  [[nodiscard]] int columns() const { return static_cast<int>(first.size()) - 1; }
  [[nodiscard]] std::size_t blocks() const { return rows.size(); }
  /// Index of the block (row ≥ column); −1 where the pattern has none.
  [[nodiscard]] int find(int row, int column) const;
};

/// Lower half of a symmetric matrix of 6×6 blocks.
struct BlockMatrix {
  BlockPattern pattern;
  std::vector<Matrix6d> blocks;  ///< per block of the pattern
};

/// Takes an unknown out: its rows and columns become the unit matrix's.
void fix_block(BlockMatrix& matrix, int fixed);

/// The pattern in which all blocks of a group meet each other, for every group: what is left after
/// eliminating an unknown that touches `groups[i]` (each rising, without repeats).
[[nodiscard]] BlockPattern pattern_of_groups(int columns,
                                             const std::vector<std::vector<int>>& groups);

}  // namespace waymark
