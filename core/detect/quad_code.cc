#include "core/detect/quad_code.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/square_homography.h"

namespace waymark {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Grey value between pixels' middles; beyond the image that of its edge.
double grey_at(const GrayView& image, double x, double y) {
  const double inside_x = std::clamp(x, 0.0, image.width_px - 1.001);
  const double inside_y = std::clamp(y, 0.0, image.height_px - 1.001);
  const int left = static_cast<int>(inside_x);
  const int top = static_cast<int>(inside_y);
  const double right_share = inside_x - left;
  const double below_share = inside_y - top;
  const std::uint8_t* above = image.row(top) + left;
  const std::uint8_t* below = image.row(top + 1) + left;
  const double upper = above[0] + right_share * (above[1] - above[0]);
  const double lower = below[0] + right_share * (below[1] - below[0]);
  return upper + below_share * (lower - upper);
}

/// What a cell is in an image that shows the square dark.
enum class Shown : std::uint8_t { black, white, code, nothing };

Shown shown_as(CellKind kind, bool negative) {
  switch (kind) {
    case CellKind::black:
      return negative ? Shown::white : Shown::black;
    case CellKind::white:
      return negative ? Shown::black : Shown::white;
    case CellKind::code:
      return Shown::code;
    default:
      return Shown::nothing;
  }
}

/// The greys of a marker's cells and of a ring around them.
class Cells {
 public:
  explicit Cells(const MarkerLayout& layout)
      : square_cells_(layout.square_cells()),
        first_(-layout.outside_cells()),
        side_(layout.all_cells()) {
    for (int row = first(); row < end(); ++row) {
      for (int column = first(); column < end(); ++column) {
        shown_[index(row, column)] = shown_as(layout.at({row, column}), layout.is_light());
      }
    }
  }

  [[nodiscard]] int square_cells() const { return square_cells_; }
  /// Rows and columns of the marker: [first, end).
  [[nodiscard]] int first() const { return first_; }
  [[nodiscard]] int end() const { return first_ + side_; }
  [[nodiscard]] double& at(int row, int column) { return greys_[index(row, column)]; }
  [[nodiscard]] double at(int row, int column) const { return greys_[index(row, column)]; }
  /// 1, and the cell's place from the square's middle: −1 … 1 within the square.
  [[nodiscard]] Vector3d place(int row, int column) const {
    return {1, (2 * column + 1.0) / square_cells() - 1, (2 * row + 1.0) / square_cells() - 1};
  }
  /// All of the marker's, row by row, with what each shows.
  template <typename Use>
  void for_each(const Use& use) const {
    for (int row = first(); row < end(); ++row) {
      for (int column = first(); column < end(); ++column) {
        const Shown what = shown_[index(row, column)];
        if (what != Shown::nothing) use(row, column, what);
      }
    }
  }

 private:
  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>((row - first_ + 1) * (side_ + 2) + column - first_ + 1);
  }

  static constexpr std::size_t kMost = kMaxMarkerCells + 2;

  int square_cells_;
  int first_;
  int side_;
  std::array<Shown, kMost * kMost> shown_;
  std::array<double, kMost * kMost> greys_;
};

/// The greys of a marker's cells and of a ring around them; cells of some pixels are sampled at
/// four places.
Cells sampled(const GrayView& image, const Eigen::Matrix3d& pixel_from_unit,
              const MarkerLayout& layout, double cell_px) {
  constexpr double kLargeCellPx = 4;
  constexpr double kOff = 0.2;
  Cells cells(layout);
  const Vector3d per_column = pixel_from_unit.col(0) / layout.square_cells();
  const Vector3d per_row = pixel_from_unit.col(1) / layout.square_cells();
  const auto grey = [&](double row, double column) {
    const Vector3d at = pixel_from_unit.col(2) + row * per_row + column * per_column;
    constexpr double kHorizon = 1e-3;
    if (!(at.z() > kHorizon)) return 0.0;
    return grey_at(image, at.x() / at.z(), at.y() / at.z());
  };
  for (int row = cells.first() - 1; row <= cells.end(); ++row) {
    for (int column = cells.first() - 1; column <= cells.end(); ++column) {
      const double y = row + 0.5;
      const double x = column + 0.5;
      cells.at(row, column) = cell_px < kLargeCellPx
                                  ? grey(y, x)
                                  : 0.25 * (grey(y - kOff, x) + grey(y + kOff, x) +
                                            grey(y, x - kOff) + grey(y, x + kOff));
    }
  }
  return cells;
}

/// How much of a cell's difference from its two neighbours blur has taken, as a share of what is
/// left: cells of `cell_px`, all of one grey, under a Gaussian.
double taken_by_blur(double cell_px) {
  constexpr double kBlurPx = 0.85;  // point spread, pixel and interpolation of a sharp image
  constexpr double kMost = 1;       // noise grows likewise
  const double own = std::erf(cell_px / (2 * std::sqrt(2.0) * kBlurPx));
  return std::min(kMost, (1 - own) / own);
}

/// Gives every cell back what it has mixed with its neighbours in its row and column.
void sharpen(double column_px, double row_px, Cells& cells) {
  const double across = 0.5 * taken_by_blur(column_px);
  const double down = 0.5 * taken_by_blur(row_px);
  const Cells seen = cells;
  cells.for_each([&](int row, int column, Shown) {
    const double here = seen.at(row, column);
    cells.at(row, column) +=
        across * (2 * here - seen.at(row, column - 1) - seen.at(row, column + 1)) +
        down * (2 * here - seen.at(row - 1, column) - seen.at(row + 1, column));
  });
}

/// A plane of greys: level and slopes, by Cells::place.
using Plane = Vector3d;

/// Through the greys of what is black whatever the id, whose places' moments are diagonal.
Plane black_plane(const Cells& cells) {
  Vector3d sums = Vector3d::Zero();
  Vector3d squares = Vector3d::Zero();
  cells.for_each([&](int row, int column, Shown what) {
    if (what != Shown::black) return;
    const Vector3d place = cells.place(row, column);
    sums += cells.at(row, column) * place;
    squares += place.cwiseProduct(place);
  });
  return sums.cwiseQuotient(squares);
}

/// How far cells that are white by half of `contrast` lie above black; its slopes are held by a few
/// cells' weight, for there may be few white ones. Zero where there are none.
Plane contrast_plane(const Cells& cells, const Plane& black, const Plane& contrast) {
  Eigen::Matrix3d moments = Vector3d(0, 1.5, 1.5).asDiagonal();
  Vector3d sums = Vector3d::Zero();
  cells.for_each([&](int row, int column, Shown what) {
    if (what == Shown::black) return;
    const Vector3d place = cells.place(row, column);
    const double above = cells.at(row, column) - black.dot(place);
    if (above <= 0.5 * contrast.dot(place)) return;
    moments += place * place.transpose();
    sums += above * place;
  });
  if (moments(0, 0) == 0) return Plane::Zero();
  return moments.inverse() * sums;
}

/// The cells' greatest height above black, of a few.
Plane most_contrast(const Cells& cells, const Plane& black) {
  std::array<double, 2> most{};
  cells.for_each([&](int row, int column, Shown what) {
    if (what == Shown::black) return;
    const double above = cells.at(row, column) - black.dot(cells.place(row, column));
    if (above > most[0]) most[0] = above;
    if (most[0] > most[1]) std::swap(most[0], most[1]);
  });
  return {0.5 * (most[0] + most[1]), 0, 0};
}

std::optional<QuadCode> judged(const Cells& cells, bool negative, const Plane& black,
                               const Plane& contrast) {
  QuadCode result;
  result.contrast_grey = contrast[0];
  int known = 0;
  int wrong = 0;
  int bit = 0;
  int all = 0;
  double greyness = 0;
  cells.for_each([&](int row, int column, Shown what) {
    const Vector3d place = cells.place(row, column);
    const double share =
        (cells.at(row, column) - black.dot(place)) / std::max(1.0, contrast.dot(place));
    const bool white = share > 0.5;
    greyness += std::abs(share - (white ? 1 : 0));
    ++all;
    if (what != Shown::code) {
      ++known;
      if (white != (what == Shown::white)) ++wrong;
      return;
    }
    if (white != negative) result.code |= std::uint64_t{1} << bit;
    ++bit;
  });
  if (wrong > known / 8) return std::nullopt;
  result.greyness = greyness / all;
  return result;
}

}  // namespace

std::optional<QuadCode> read_quad_code(const GrayView& image, const ImageCorners& corners,
                                       const MarkerLayout& layout, double least_contrast_grey) {
  const auto pixel_from_unit = homography_from_unit_square(corners);
  if (!pixel_from_unit) return std::nullopt;
  const double share = 0.5 / layout.square_cells();
  const double column_px =
      share * ((corners[1] - corners[0]).norm() + (corners[2] - corners[3]).norm());
  const double row_px =
      share * ((corners[3] - corners[0]).norm() + (corners[2] - corners[1]).norm());
  Cells cells = sampled(image, *pixel_from_unit, layout, std::min(column_px, row_px));
  sharpen(column_px, row_px, cells);
  const Plane black = black_plane(cells);
  Plane contrast = most_contrast(cells, black);
  if (contrast[0] < least_contrast_grey) return std::nullopt;
  for (int i = 0; i < 2; ++i) contrast = contrast_plane(cells, black, contrast);
  if (contrast[0] < least_contrast_grey) return std::nullopt;
  return judged(cells, layout.is_light(), black, contrast);
}

}  // namespace waymark
