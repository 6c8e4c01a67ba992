#include "simulator/plate_painter.h"

#include <algorithm>
#include <utility>

#include "simulator/vector_clones.h"

namespace waymark::simulator {

PlatePainter::PlatePainter(const MarkerPrint& print, const PlateInView& plate, int surface,
                           const SubpixelGrid& grid)
    : print_(&print), plane_(plate.plane), surface_(surface) {
  const Tile& apron = grid.apron;
  begin_ = static_cast<std::size_t>(std::max(plate.left_px - apron.x0, 0));
  end_ = static_cast<std::size_t>(std::min(plate.right_px - apron.x0 + 1, apron.width));
  first_row_ = static_cast<std::size_t>(std::max(plate.top_px - apron.y0, 0) * grid.oversampling);
  last_row_ = static_cast<std::size_t>(
      std::min(plate.bottom_px - apron.y0 + 1, apron.height) * grid.oversampling - 1);
  const std::size_t corners = (end_ - begin_ + 1) * grid.phases();
  for (CornerRow* row : {&upper_, &lower_}) {
    row->x.resize(corners);
    row->y.resize(corners);
    row->cell.resize(corners);
  }
}

WAYMARK_VECTOR_CLONES void PlatePainter::advance(const CornerRays& corners,
                                                 const SubpixelGrid& grid, float share) {
  std::swap(upper_, lower_);
  const PlaneMap map = plane_.at(share);
  const auto side = static_cast<float>(print_->side_cells());
  const float half = 0.5F * side;
  const std::size_t count = end_ - begin_ + 1;
  for (std::size_t p = 0; p < grid.phases(); ++p) {
    const std::size_t first = p * (grid.columns() + 1) + begin_;
    float* out_x = lower_.x.data() + p * count;
    float* out_y = lower_.y.data() + p * count;
    std::int32_t* out_cell = lower_.cell.data() + p * count;
    for (std::size_t i = 0; i < count; ++i) {
      const float x = corners.x[first + i];
      const float y = corners.y[first + i];
      const float z = corners.z[first + i];
      // Beyond the plate's horizon the quotient is far outside the plate, which is all that
      // matters.
      const float depth = map.depth.x() * x + map.depth.y() * y + map.depth.z() * z;
      const float per_depth = 1.0F / std::min(depth, -1e-6F);
      const float px =
          half + (map.across.x() * x + map.across.y() * y + map.across.z() * z) * per_depth;
      const float py =
          half - (map.above.x() * x + map.above.y() * y + map.above.z() * z) * per_depth;
      out_x[i] = px;
      out_y[i] = py;
      // Cells −1 and `side` stand for all that lies beyond the plate; + 1 makes truncation a floor.
      const auto cell_x = static_cast<std::int32_t>(std::min(std::max(px, -1.0F), side) + 1.0F);
      const auto cell_y = static_cast<std::int32_t>(std::min(std::max(py, -1.0F), side) + 1.0F);
      out_cell[i] = cell_y * (print_->side_cells() + 2) + cell_x;
    }
  }
}

void PlatePainter::paint(const SubpixelGrid& grid, const std::int32_t* seen, std::int32_t key,
                         float* albedo) const {
  const std::size_t stride = end_ - begin_ + 1;
  const std::size_t phases = grid.phases();
  for (std::size_t p = 0; p < phases; ++p) {
    const std::size_t left = p * stride;
    const std::size_t right = p + 1 < phases ? left + stride : 1;
    for (std::size_t i = 0; i + begin_ < end_; ++i) {
      const std::size_t out = p * grid.columns() + begin_ + i;
      if (seen != nullptr && seen[out] != key) continue;
      const std::size_t l = left + i;
      const std::size_t r = right + i;
      const std::int32_t cell = upper_.cell[l];
      // A cell is convex: four corners in it, all of the footprint in it.
      if (((cell ^ upper_.cell[r]) | (cell ^ lower_.cell[r]) | (cell ^ lower_.cell[l])) == 0) {
        const float in_cell = print_->albedo_of_cell(static_cast<std::size_t>(cell));
        if (in_cell >= 0) albedo[out] = in_cell;
        continue;
      }
      albedo[out] = print_->albedo({{upper_.x[l], upper_.x[r], lower_.x[r], lower_.x[l]},
                                    {upper_.y[l], upper_.y[r], lower_.y[r], lower_.y[l]}},
                                   albedo[out]);
    }
  }
}

}  // namespace waymark::simulator
