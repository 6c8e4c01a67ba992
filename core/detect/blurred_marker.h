#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/marker/marker_bits.h"

namespace waymark {

/// How sharply a marker's cells are seen along one of its axes at some pixel.
struct AxisView {
  double place = 0;         ///< cells from the marker's left or upper side
  double cells_per_px = 0;  ///< how fast `place` changes across its edges
  double blur_px = 0;       ///< standard deviation of the lens's blur across its edges
};

/// How white a blurred marker is at a point (0 black, 1 white), with derivatives.
struct Whiteness {
  double value = 0;
  Eigen::Vector2d d_place = Eigen::Vector2d::Zero();  ///< by place in cells, x and y
  Eigen::Vector2d d_blur = Eigen::Vector2d::Zero();   ///< by blur in px, of x and y
  double d_growth = 0;                                ///< by the growth of white in px
};

/// A marker's cells and a ring of paper around them, blurred by a lens (Gaussian) and by pixels
/// (one pixel wide, which in sharp images no Gaussian is), with white grown by some pixels over
/// every edge (print, blooming). Exact without growth, and with it along rows and columns; where
/// these meet they are joined: w = Σ A_j W_j + Σ C_i W_i − Σ a W W (EDGES, Model).
class BlurredMarker {
 public:
  explicit BlurredMarker(const MarkerBits& bits);

  [[nodiscard]] Whiteness at(const AxisView& x, const AxisView& y, double growth_px) const;

  /// Whether black and white meet within `reach` cells (0–0.5, along either axis) of a place in
  /// cells.
  [[nodiscard]] bool has_edge_near(const Eigen::Vector2d& place, double reach) const;

 private:
  [[nodiscard]] double cell(std::size_t row, std::size_t column) const {
    return white_[row * across_ + column];
  }
  [[nodiscard]] bool is_of_one_colour(std::size_t first_row, std::size_t end_row,
                                      std::size_t first_column, std::size_t end_column) const;

  std::size_t across_;         ///< cells along a side with the ring
  std::vector<double> white_;  ///< row by row, the ring included
};

}  // namespace waymark
