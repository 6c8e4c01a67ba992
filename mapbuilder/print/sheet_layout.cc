#include "mapbuilder/print/sheet_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/marker/marker_layout.h"

namespace waymark {
namespace {

/// Printers leave this much of the paper's edge white.
constexpr double kEdge_mm = 5;
/// Below the markers: the ruler with what to do with it.
constexpr double kRulerStrip_mm = 17;
/// Below a marker's white margin: its name.
constexpr double kNameStrip_mm = 7;
constexpr double kText_mm = 3;
/// By which the parts of a large marker overlap, to be glued.
constexpr double kGlue_mm = 10;

/// A smaller part of a marker is no help to anybody who glues it.
constexpr double kSmallestPart_mm = 40;

/// A marker with the paper that belongs to it.
struct Block {
  double size_mm;
  double around_mm;  ///< from the square to the block's edge: what the marker has there, and paper
  double paper_mm;   ///< a cell of it, white

  [[nodiscard]] double width_mm() const { return size_mm + 2 * around_mm; }
  [[nodiscard]] double height_mm() const { return width_mm() + kNameStrip_mm; }
};

Block block_of(const MarkerBatch& batch) {
  const double size_mm = 1e3 * batch.size_m;
  const MarkerLayout& layout = marker_layout(batch.family);
  const double cell_mm = size_mm / layout.square_cells();
  return {size_mm, (layout.outside_cells() + 1) * cell_mm, cell_mm};
}

/// How many blocks stand side by side in a length, their black at least kEdge_mm from its ends.
int fitting(double length_mm, double block_mm, double paper_mm) {
  const double usable = length_mm - 2 * std::max(0.0, kEdge_mm - paper_mm);
  return static_cast<int>(std::floor(usable / block_mm + 1e-9));
}

/// Rows and columns of blocks on a sheet.
struct Grid {
  int columns = 0;
  int rows = 0;
  [[nodiscard]] int count() const { return columns * rows; }
};

Grid grid_on(const Paper& paper, const Block& block) {
  return {fitting(paper.width_mm, block.width_mm(), block.paper_mm),
          fitting(paper.height_mm - kRulerStrip_mm, block.height_mm(), block.paper_mm)};
}

void add_ruler(Sheet& sheet) {
  double long_mm = 20;
  for (const double mm : {50.0, 100.0, 200.0}) {
    if (sheet.paper.width_mm >= mm + 2 * kEdge_mm) long_mm = mm;
  }
  const double left = (sheet.paper.width_mm - long_mm) / 2;
  const double y = sheet.paper.height_mm - kEdge_mm - 4;
  sheet.lines.push_back({left, y, left + long_mm, y});
  for (int mm = 0; mm <= static_cast<int>(long_mm); mm += 10) {
    const double tick = mm % 50 == 0 ? 4 : 2;
    sheet.lines.push_back({left + mm, y - tick, left + mm, y});
  }
  sheet.labels.push_back(
      {left, y + 3.5, 2.6,
       fmt::format(
           "{0:.0f} mm from end to end. If not, measure: ______ mm, and state print_scale = "
           "that / {0:.0f} in markers.toml.",
           long_mm)});
}

Sheet empty_sheet(const Paper& paper) {
  Sheet sheet;
  sheet.paper = paper;
  add_ruler(sheet);
  return sheet;
}

std::string name_of_marker(const MarkerBatch& batch, int number) {
  return fmt::format("{} {}   square {:g} mm", name_of(batch.family), number, 1e3 * batch.size_m);
}

/// An arrow that points up, and the marker's name behind it, small enough for `width_mm`.
void add_name(Sheet& sheet, double left_mm, double baseline_mm, double width_mm,
              const std::string& name) {
  constexpr double kArrow_mm = 4;
  constexpr double kCharacterWidth = 0.52;  // of Helvetica's height, on average
  const std::string text = "up   " + name;
  const double height_mm = std::min(
      kText_mm, (width_mm - kArrow_mm) / (kCharacterWidth * static_cast<double>(text.size())));
  const double x = left_mm + 1.5;
  sheet.lines.push_back({x, baseline_mm, x, baseline_mm - kText_mm});
  sheet.lines.push_back({x, baseline_mm - kText_mm, x - 1, baseline_mm - kText_mm + 1});
  sheet.lines.push_back({x, baseline_mm - kText_mm, x + 1, baseline_mm - kText_mm + 1});
  sheet.labels.push_back({left_mm + kArrow_mm, baseline_mm, height_mm, text});
}

/// Short lines outside of a box's corners, where they can be printed.
void add_cut_marks(Sheet& sheet, const Box& box) {
  constexpr double kLength_mm = 4;
  const auto printable = [&](double x, double y) {
    return x >= 0 && y >= 0 && x <= sheet.paper.width_mm && y <= sheet.paper.height_mm;
  };
  for (const double x : {box.left_mm, box.right_mm()}) {
    for (const double y : {box.top_mm, box.bottom_mm()}) {
      if (!printable(x, y)) continue;
      const double inward_x = x == box.left_mm ? 1 : -1;
      const double inward_y = y == box.top_mm ? 1 : -1;
      const double reach = std::min(kLength_mm, 0.1 * box.width_mm);
      sheet.lines.push_back({x, y, x + inward_x * reach, y});
      sheet.lines.push_back({x, y, x, y + inward_y * reach});
    }
  }
}

void add_block(Sheet& sheet, const MarkerBatch& batch, int number, const Block& block, double left,
               double top) {
  const Box square{left + block.around_mm, top + block.around_mm, block.size_mm, block.size_mm};
  const Box paper{left, top, block.width_mm(), block.width_mm()};
  sheet.squares.push_back({{batch.family, number}, square, paper});
  const double baseline = top + block.width_mm() + kText_mm + 1;
  const double name_left = std::max(left + std::min(block.around_mm, 2.0), kEdge_mm);
  add_name(sheet, name_left, baseline, left + block.width_mm() - name_left - 1,
           name_of_marker(batch, number));
  add_cut_marks(sheet, {left, top, block.width_mm(), block.height_mm()});
}

/// Several markers a sheet.
void lay_out_grid(const MarkerBatch& batch, const Paper& paper, const Grid& grid,
                  std::vector<Sheet>& sheets) {
  const Block block = block_of(batch);
  const double left = (paper.width_mm - grid.columns * block.width_mm()) / 2;
  const double top =
      std::max(0.0, (paper.height_mm - kRulerStrip_mm - grid.rows * block.height_mm()) / 2);
  for (std::size_t i = 0; i < batch.numbers.size(); ++i) {
    const int place = static_cast<int>(i) % grid.count();
    const int row = place / grid.columns;
    if (place == 0) sheets.push_back(empty_sheet(paper));
    add_block(sheets.back(), batch, batch.numbers[i], block,
              left + place % grid.columns * block.width_mm(), top + row * block.height_mm());
  }
}

/// How a marker that is larger than a sheet is shown: windows of one size, in a grid.
struct Parts {
  Box window;
  Grid grid;
};

Parts parts_of(const Block& block, const Paper& paper) {
  const double margin = 2 * kEdge_mm;
  const Box window{margin, margin, paper.width_mm - 2 * margin,
                   paper.height_mm - kRulerStrip_mm - kNameStrip_mm - 2 * margin};
  const auto parts = [&](double window_mm) {
    const double step = window_mm - kGlue_mm;
    return std::max(1, static_cast<int>(std::ceil((block.width_mm() - kGlue_mm) / step)));
  };
  if (std::min(window.width_mm, window.height_mm) < kSmallestPart_mm) return {window, {}};
  return {window, {parts(window.width_mm), parts(window.height_mm)}};
}

/// One marker on several sheets: each shows a window of it.
void lay_out_parts(const MarkerBatch& batch, int number, const Paper& paper,
                   std::vector<Sheet>& sheets) {
  const Block block = block_of(batch);
  const auto [window, grid] = parts_of(block, paper);
  const auto [columns, rows] = grid;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      Sheet sheet = empty_sheet(paper);
      const double left = window.left_mm - column * (window.width_mm - kGlue_mm);
      const double top = window.top_mm - row * (window.height_mm - kGlue_mm);
      sheet.squares.push_back(
          {{batch.family, number},
           {left + block.around_mm, top + block.around_mm, block.size_mm, block.size_mm},
           window});
      add_cut_marks(sheet, window);
      add_name(sheet, window.left_mm, window.bottom_mm() + kText_mm + 2, window.width_mm,
               fmt::format("{}   part {} of {} (row {}, column {}); parts overlap by {:g} mm",
                           name_of_marker(batch, number), row * columns + column + 1,
                           rows * columns, row + 1, column + 1, kGlue_mm));
      sheets.push_back(std::move(sheet));
    }
  }
}

/// Where a batch's markers go: several a sheet, or each on several.
struct Plan {
  Paper paper;
  Grid grid;   ///< of markers on a sheet; none where one fits on none
  Grid parts;  ///< of sheets with one marker, then; none where the paper is too small for that
};

Plan plan_of(const MarkerBatch& batch, const Paper& paper) {
  const Block block = block_of(batch);
  const Grid upright = grid_on(paper, block);
  const Grid turned = grid_on(paper.turned(), block);
  const bool turn = turned.count() > upright.count();
  Plan plan{turn ? paper.turned() : paper, turn ? turned : upright, {}};
  if (plan.grid.count() == 0) plan = {paper, {}, parts_of(block, paper).grid};
  return plan;
}

/// nullopt where the paper is too small.
std::optional<double> sheets_of(const MarkerBatch& batch, const Plan& plan) {
  const auto markers = static_cast<double>(batch.numbers.size());
  if (plan.grid.count() > 0) return std::ceil(markers / plan.grid.count());
  if (plan.parts.count() == 0) return std::nullopt;
  return markers * plan.parts.columns * plan.parts.rows;
}

}  // namespace

Expected<std::vector<Sheet>> lay_out(const std::vector<MarkerBatch>& batches, const Paper& paper) {
  double count = 0;
  for (const MarkerBatch& batch : batches) {
    const auto some = sheets_of(batch, plan_of(batch, paper));
    if (!some) {
      return fail(ErrorKind::usage,
                  "--paper: {:g} x {:g} mm is too small for markers of {:g} m, and for parts of "
                  "them to glue; take larger paper or smaller markers",
                  paper.width_mm, paper.height_mm, batch.size_m);
    }
    count += *some;
  }
  if (count > kMostSheets) {
    return fail(ErrorKind::usage,
                "print: {:.0f} sheets of {:g} x {:g} mm, at most {} go into a PDF; take larger "
                "paper, or print ids in several turns",
                count, paper.width_mm, paper.height_mm, kMostSheets);
  }
  std::vector<Sheet> sheets;
  for (const MarkerBatch& batch : batches) {
    const Plan plan = plan_of(batch, paper);
    if (plan.grid.count() > 0) {
      lay_out_grid(batch, plan.paper, plan.grid, sheets);
      continue;
    }
    for (const int number : batch.numbers) lay_out_parts(batch, number, paper, sheets);
  }
  return sheets;
}

}  // namespace waymark
