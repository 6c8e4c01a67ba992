#include "core/detect/cell_steps.h"

#include <Eigen/Dense>
#include <cmath>

#include "core/detect/gaussian_step.h"
#include "core/geometry/square_homography.h"

namespace waymark {
namespace {

Eigen::Matrix3d unit_from_pixel(const ImageCorners& corners, std::size_t side) {
  const auto pixel_from_unit = homography_from_unit_square(
      {corners[side], corners[(side + 1) % 4], corners[(side + 2) % 4], corners[(side + 3) % 4]});
  return pixel_from_unit ? Eigen::Matrix3d(pixel_from_unit->inverse()) : Eigen::Matrix3d::Zero();
}

}  // namespace

CellSteps::CellSteps(const ImageCorners& corners, std::size_t side, const MarkerBits& bits)
    : unit_from_pixel_(unit_from_pixel(corners, side)), side_(side), bits_(&bits) {}

bool CellSteps::is_white(int row, int column) const {
  const int last = bits_->cells - 1;
  if (column < -bits_->outside || column > last + bits_->outside) return false;
  switch (side_) {
    case 0:
      return bits_->is_white(row, column);
    case 1:
      return bits_->is_white(column, last - row);
    case 2:
      return bits_->is_white(last - row, last - column);
    default:
      return bits_->is_white(last - column, row);
  }
}

double CellSteps::whiteness(int row, double column, double columns_per_px, double blur_px) const {
  if (!(column >= -bits_->outside && column < bits_->cells + bits_->outside)) return 0;
  const int cell = static_cast<int>(std::floor(column));
  const double here = is_white(row, cell) ? 1.0 : 0.0;
  const double within = column - cell;
  const bool nearer_to_next = within > 0.5;
  const double there = is_white(row, nearer_to_next ? cell + 1 : cell - 1) ? 1.0 : 0.0;
  if (here == there) return here;
  const double distance_px = (nearer_to_next ? 1 - within : within) / columns_per_px;
  return here + (there - here) * gaussian_step(-distance_px / blur_px).value;
}

InwardSteps CellSteps::behind(const Eigen::Vector2d& pixel, const Eigen::Vector2d& inward,
                              const Eigen::Vector2d& along, double blur_px, double reach_px) const {
  const Eigen::Vector3d at = unit_from_pixel_ * pixel.homogeneous();
  const Eigen::Vector3d per_px = unit_from_pixel_.leftCols<2>() * inward;
  const Eigen::Vector3d aside = unit_from_pixel_.leftCols<2>() * along;
  const int cells = bits_->cells;
  InwardSteps steps;
  // (at.y + x per_px.y) / (at.z + x per_px.z) = row / cells, solved for the depth x
  const auto depth_of = [&](int row) {
    const double down = static_cast<double>(row) / cells;
    return (down * at.z() - at.y()) / (per_px.y() - down * per_px.z());
  };
  const auto whiteness_of = [&](int row, double depth) {
    const Eigen::Vector3d there = at + depth * per_px;
    const double across = there.x() / there.z();
    const double columns_per_px = std::abs(cells * (aside.x() - across * aside.z()) / there.z());
    return whiteness(row, cells * across, columns_per_px, blur_px);
  };
  double before = 0;
  for (std::size_t i = 0; i < InwardSteps::kRows; ++i) {
    const int row = static_cast<int>(i) + 1;
    const double depth = depth_of(row);
    steps.depth_px[i] = depth;
    steps.change[i] = 0;
    if (!(depth < reach_px)) continue;
    const double here = row < cells ? whiteness_of(row, depth) : 0;
    steps.change[i] = here - before;
    before = here;
  }
  steps.border_px = steps.depth_px[0];
  const double paper_depth = depth_of(-1);
  steps.paper_px = -paper_depth;
  // Of a round marker nothing is known beyond its own cells.
  constexpr int kBeyond = -2;
  if (bits_->outside >= -kBeyond && bits_->outside < 3 && -paper_depth < reach_px) {
    steps.paper_end = 1 - whiteness_of(kBeyond, paper_depth);
  }
  return steps;
}

}  // namespace waymark
