#pragma once

#include <vector>

#include "core/base/error.h"
#include "mapbuilder/print/sheet.h"

namespace waymark {

/// Markers of one family and size, in the order in which they are printed.
struct MarkerBatch {
  Family family = Family::tag36h11;
  std::vector<int> numbers;  ///< within the family
  double size_m = 0;         ///< outer edge of the black border
};

/// Lays markers out on sheets: as many as fit on one, each with a cell of white paper around it,
/// its name, which side is up, and marks to cut along; a marker that fits on no sheet on several,
/// which overlap by a strip to glue. Paper is turned where more fit then. Every sheet has a ruler,
/// for printers scale: 200 mm, on narrow paper 100, 50 or 20 mm. usage for paper too small for a
/// part of a marker that fits on no sheet, and for more than kMostSheets.
[[nodiscard]] Expected<std::vector<Sheet>> lay_out(const std::vector<MarkerBatch>& batches,
                                                   const Paper& paper);

/// The library that makes the PDF takes 32,767 pages.
inline constexpr int kMostSheets = 20000;

}  // namespace waymark
