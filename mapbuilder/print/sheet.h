#pragma once

#include <string>
#include <vector>

#include "core/marker/marker_id.h"
#include "mapbuilder/print/paper.h"

namespace waymark {

/// A rectangle on a sheet; mm from its upper left corner.
struct Box {
  double left_mm = 0;
  double top_mm = 0;
  double width_mm = 0;
  double height_mm = 0;

  [[nodiscard]] double right_mm() const { return left_mm + width_mm; }
  [[nodiscard]] double bottom_mm() const { return top_mm + height_mm; }
};

/// A marker by its square on a sheet, upright; only what lies in `window` is printed.
struct PrintedSquare {
  MarkerId id;
  Box square;
  Box window;
};

/// A hairline.
struct Line {
  double x0_mm = 0, y0_mm = 0, x1_mm = 0, y1_mm = 0;
};

/// Text whose line begins at a place.
struct Label {
  double left_mm = 0;
  double baseline_mm = 0;
  double height_mm = 3;
  std::string text;
};

/// A page to print.
struct Sheet {
  Paper paper;
  std::vector<PrintedSquare> squares;
  std::vector<Line> lines;
  std::vector<Label> labels;
};

}  // namespace waymark
