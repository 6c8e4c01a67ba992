#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "core/marker/marker_bits.h"
#include "core/marker/marker_geometry.h"

namespace waymark {

/// What lies behind one point of a marker's side, along the side's inward normal: at each depth the
/// whiteness changes by `change`.
struct InwardSteps {
  static constexpr std::size_t kRows = 3;
  std::array<double, kRows> depth_px;
  std::array<double, kRows> change;
  double border_px = 0;  ///< width of the black border there
  double paper_px = 0;   ///< width of one cell of paper outside of it
  /// Share of the contrast that is lost beyond that cell: where the marker has cells there.
  std::optional<double> paper_end;
};

/// The cells behind one side of a marker as the image shows them: the black border, then the first
/// rows of the code; and those before it, of markers that have some there.
class CellSteps {
 public:
  /// `corners`: the marker's (px); `side`: 0 top, 1 right, 2 bottom, 3 left. The lens's bend within
  /// a marker is neglected here. Corners on a line give a depthless marker.
  CellSteps(const ImageCorners& corners, std::size_t side, const MarkerBits& bits);

  [[nodiscard]] int cells_across() const { return bits_->cells; }

  /// Behind the side's point `pixel`, no deeper than `reach_px`; `inward` and `along` are unit.
  /// Between two cells of a row the whiteness is blended by the blur.
  [[nodiscard]] InwardSteps behind(const Eigen::Vector2d& pixel, const Eigen::Vector2d& inward,
                                   const Eigen::Vector2d& along, double blur_px,
                                   double reach_px) const;

 private:
  [[nodiscard]] double whiteness(int row, double column, double columns_per_px,
                                 double blur_px) const;
  [[nodiscard]] bool is_white(int row, int column) const;

  Eigen::Matrix3d unit_from_pixel_;
  std::size_t side_;
  const MarkerBits* bits_;
};

}  // namespace waymark
