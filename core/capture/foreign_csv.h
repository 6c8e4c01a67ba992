#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/cause.h"
#include "core/capture/detections_csv.h"

namespace waymark {

/// Recognizes tables of detections as spreadsheets, other libraries and other conventions write
/// them, and says what to write instead. Empty texts: nothing foreign is seen.

/// By the first line: UTF-16.
[[nodiscard]] std::string_view foreign_encoding(std::string_view first_line);

/// By the line that ought to name the columns: semicolons, tabs, quotes, or numbers.
[[nodiscard]] std::string foreign_header(std::string_view header);

/// By a t_ns that is no whole number of ns.
[[nodiscard]] std::string_view why_no_stamp(std::string_view field);

/// How the corners of a table's rows run.
class CornerOrders {
 public:
  /// Whether they run clockwise as seen in the image (y down), as top-left, top-right,
  /// bottom-right, bottom-left do wherever the camera stands.
  bool add(const ImageCorners& corners);

  [[nodiscard]] std::size_t misordered() const { return rows_ - clockwise_; }
  /// What most rows have in common, if it is not the right order.
  [[nodiscard]] std::string doubt() const;

 private:
  std::size_t rows_ = 0;
  std::size_t clockwise_ = 0;
  std::size_t counterclockwise_ = 0;
  std::size_t crossed_ = 0;  ///< the outline crosses itself, whatever its sense
};

/// What is wrong with a table whose every row can be read.
struct TableDoubt {
  Cause cause;
  std::string text;
};
/// Rows twice, another order of corners, stamps that are none.
[[nodiscard]] std::optional<TableDoubt> doubt_of_table(const DetectionsTable& table,
                                                       const CornerOrders& orders, bool monotonic);

}  // namespace waymark
