#include "mapbuilder/bundle/block_matrix.h"

#include <algorithm>

namespace waymark {

int BlockPattern::find(int row, int column) const {
  const auto begin = rows.begin() + first[static_cast<std::size_t>(column)];
  const auto end = rows.begin() + first[static_cast<std::size_t>(column) + 1];
  const auto at = std::lower_bound(begin, end, row);
  return at != end && *at == row ? static_cast<int>(at - rows.begin()) : -1;
}

void fix_block(BlockMatrix& matrix, int fixed) {
  const BlockPattern& pattern = matrix.pattern;
  for (int column = 0; column < pattern.columns(); ++column) {
    for (int b = pattern.first[static_cast<std::size_t>(column)];
         b < pattern.first[static_cast<std::size_t>(column) + 1]; ++b) {
      const int row = pattern.rows[static_cast<std::size_t>(b)];
      if (row != fixed && column != fixed) continue;
      Matrix6d& block = matrix.blocks[static_cast<std::size_t>(b)];
      if (row == column) {
        block.setIdentity();
      } else {
        block.setZero();
      }
    }
  }
}

BlockPattern pattern_of_groups(int columns, const std::vector<std::vector<int>>& groups) {
  std::vector<std::vector<int>> groups_of(static_cast<std::size_t>(columns));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const int block : groups[g]) {
      groups_of[static_cast<std::size_t>(block)].push_back(static_cast<int>(g));
    }
  }
  BlockPattern pattern;
  std::vector<int> seen_by(static_cast<std::size_t>(columns), -1);
  for (int column = 0; column < columns; ++column) {
    pattern.first.push_back(static_cast<int>(pattern.rows.size()));
    pattern.rows.push_back(column);
    seen_by[static_cast<std::size_t>(column)] = column;
    for (const int group : groups_of[static_cast<std::size_t>(column)]) {
      for (const int row : groups[static_cast<std::size_t>(group)]) {
        if (row < column || seen_by[static_cast<std::size_t>(row)] == column) continue;
        seen_by[static_cast<std::size_t>(row)] = column;
        pattern.rows.push_back(row);
      }
    }
    std::sort(pattern.rows.begin() + pattern.first.back(), pattern.rows.end());
  }
  pattern.first.push_back(static_cast<int>(pattern.rows.size()));
  return pattern;
}

}  // namespace waymark
