#include "locd/pose/pose_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

namespace waymark {
namespace {

std::ptrdiff_t columns(const std::string& line) {
  return std::count(line.begin(), line.end(), ',') + 1;
}

TEST(PoseTable, RowsHaveTheHeadsColumns) {
  PoseEstimate estimate;
  estimate.reset(PoseReason::no_map);
  estimate.set_stamp = Stamp(1500);
  estimate.stamp = Stamp(1700);
  estimate.max_skew = Stamp(2999);
  std::string row;
  append_pose_table_row(estimate, Stamp(1000), row);
  EXPECT_EQ(columns(row), columns(pose_table_head()));
  EXPECT_TRUE(row.starts_with("500,700,3,2,nan,nan,nan,")) << row;
  EXPECT_TRUE(row.ends_with(",2\n")) << "max_skew_us: " << row;
  EXPECT_EQ(pose_table_head().back(), '\n');
}

TEST(PoseTable, RowsAreAppended) {
  PoseEstimate estimate;
  estimate.reset(PoseReason::no_map);
  std::string text;
  append_pose_table_row(estimate, Stamp(0), text);
  const std::string first = text;
  append_pose_table_row(estimate, Stamp(0), text);
  EXPECT_EQ(text, first + first);
}

}  // namespace
}  // namespace waymark
