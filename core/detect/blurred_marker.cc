#include "core/detect/blurred_marker.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.h"
#include "core/detect/gaussian_step.h"

namespace waymark {
namespace {

constexpr std::size_t kMaxAcross = kMaxSquareCells + 2;
constexpr double kHalfPixel = 0.5;

/// A function of place along an axis, with its derivatives by place, blur and growth.
struct Term {
  double value;
  double d_place;
  double d_blur;
  double d_growth;

  void add(double factor, const Term& other) {
    value += factor * other.value;
    d_place += factor * other.d_place;
    d_blur += factor * other.d_blur;
    d_growth += factor * other.d_growth;
  }
};

/// Integral of the normal distribution function up to x.
double integrated(double x, const GaussianStep& s) { return x * s.value + s.slope; }

/// From 0 to 1 over the edge at `edge`, which comes `shift_px` earlier, as pixels of one pixel's
/// width see it.
Term step(const AxisView& axis, double edge, double shift_px) {
  const double px = (axis.place - edge) / axis.cells_per_px + shift_px;
  const double near = (px - kHalfPixel) / axis.blur_px;
  const double far = (px + kHalfPixel) / axis.blur_px;
  const GaussianStep at_near = gaussian_step(near);
  const GaussianStep at_far = gaussian_step(far);
  const double per_px = at_far.value - at_near.value;
  return {axis.blur_px * (integrated(far, at_far) - integrated(near, at_near)),
          per_px / axis.cells_per_px, at_far.slope - at_near.slope, per_px};
}

/// Which of an axis's edges lie within reach of the blur at one place: [first, first + edges).
struct EdgesInReach {
  EdgesInReach(const AxisView& axis, std::size_t across, double growth_px) {
    const double reach = (kHalfPixel + GaussianTable::kReach * axis.blur_px + std::abs(growth_px)) *
                         axis.cells_per_px;
    const auto last_edge = static_cast<double>(across - 2);
    first = static_cast<std::size_t>(std::clamp(std::ceil(axis.place - reach), 0.0, last_edge + 1));
    const double last = std::clamp(std::floor(axis.place + reach), -1.0, last_edge);
    edges = static_cast<std::size_t>(std::max(0.0, last + 1 - static_cast<double>(first)));
  }

  /// Of the cells that are seen: one more than edges.
  [[nodiscard]] std::size_t end() const { return first + edges + 1; }

  std::size_t first = 0;
  std::size_t edges = 0;
};

/// What an axis shows at one place: how much of each cell between the edges in reach, and each
/// edge's step with white on its far side, and on its near side, grown.
class AxisSteps {
 public:
  AxisSteps(const AxisView& axis, const EdgesInReach& reach, double growth_px)
      : first_(reach.first), edges_(reach.edges) {
    shares_[0] = {1, 0, 0, 0};
    for (std::size_t i = 0; i < edges_; ++i) {
      const auto edge = static_cast<double>(first_ + i);
      Term plain = step(axis, edge, 0);
      plain.d_growth = 0;
      shares_[i].add(-1, plain);
      shares_[i + 1] = plain;
      rising_[i] = step(axis, edge, growth_px);
      falling_[i] = step(axis, edge, -growth_px);
      falling_[i].d_growth *= -1;
    }
  }

  /// The cells of which something is seen: [first(), end()).
  [[nodiscard]] std::size_t first() const { return first_; }
  [[nodiscard]] std::size_t end() const { return first_ + edges_ + 1; }
  [[nodiscard]] const Term& share(std::size_t cell) const { return shares_[cell - first_]; }

  /// A line of cells along the axis, `white(i)` each.
  template <typename White>
  [[nodiscard]] Term line(const White& white) const {
    Term sum{white(first_), 0, 0, 0};
    for (std::size_t i = 0; i < edges_; ++i) {
      const double change = white(first_ + i + 1) - white(first_ + i);
      if (change > 0) sum.add(1, rising_[i]);
      if (change < 0) sum.add(-1, falling_[i]);
    }
    return sum;
  }

 private:
  std::size_t first_ = 0;
  std::size_t edges_ = 0;
  std::array<Term, kMaxAcross> shares_;
  std::array<Term, kMaxAcross> rising_;
  std::array<Term, kMaxAcross> falling_;
};

/// Adds factor·along·across: `x` and `y` are the terms' axes.
void add_product(Whiteness& sum, double factor, const Term& x, const Term& y) {
  sum.value += factor * x.value * y.value;
  sum.d_place += factor * Eigen::Vector2d(x.d_place * y.value, x.value * y.d_place);
  sum.d_blur += factor * Eigen::Vector2d(x.d_blur * y.value, x.value * y.d_blur);
  sum.d_growth += factor * (x.d_growth * y.value + x.value * y.d_growth);
}

}  // namespace

BlurredMarker::BlurredMarker(const MarkerBits& bits)
    : across_(static_cast<std::size_t>(bits.cells) + 2), white_(across_ * across_, 1.0) {
  WAYMARK_CHECK(across_ <= kMaxAcross);
  const int around = std::min(1, bits.outside);
  for (int row = -around; row < bits.cells + around; ++row) {
    for (int column = -around; column < bits.cells + around; ++column) {
      white_[static_cast<std::size_t>(row + 1) * across_ + static_cast<std::size_t>(column + 1)] =
          bits.is_white(row, column) ? 1.0 : 0.0;
    }
  }
}

bool BlurredMarker::is_of_one_colour(std::size_t first_row, std::size_t end_row,
                                     std::size_t first_column, std::size_t end_column) const {
  const double first = cell(first_row, first_column);
  for (std::size_t row = first_row; row < end_row; ++row) {
    for (std::size_t column = first_column; column < end_column; ++column) {
      if (cell(row, column) != first) return false;
    }
  }
  return true;
}

bool BlurredMarker::has_edge_near(const Eigen::Vector2d& place, double reach) const {
  const auto index = [&](double cells) {
    const double last = static_cast<double>(across_) - 1;
    return static_cast<std::size_t>(std::clamp(std::floor(cells) + 1, 0.0, last));
  };
  const std::array<std::size_t, 2> columns{index(place.x() - reach), index(place.x() + reach)};
  const std::array<std::size_t, 2> rows{index(place.y() - reach), index(place.y() + reach)};
  const double first = cell(rows[0], columns[0]);
  return cell(rows[0], columns[1]) != first || cell(rows[1], columns[0]) != first ||
         cell(rows[1], columns[1]) != first;
}

Whiteness BlurredMarker::at(const AxisView& x, const AxisView& y, double growth_px) const {
  const EdgesInReach columns(x, across_, growth_px);
  const EdgesInReach rows(y, across_, growth_px);
  Whiteness sum;
  if (is_of_one_colour(rows.first, rows.end(), columns.first, columns.end())) {
    sum.value = cell(rows.first, columns.first);
    return sum;
  }
  const AxisSteps along_x(x, columns, growth_px);
  const AxisSteps along_y(y, rows, growth_px);
  for (std::size_t row = along_y.first(); row < along_y.end(); ++row) {
    const Term line = along_x.line([&](std::size_t i) { return cell(row, i); });
    add_product(sum, 1, line, along_y.share(row));
    for (std::size_t column = along_x.first(); column < along_x.end(); ++column) {
      if (cell(row, column) == 0) continue;
      add_product(sum, -1, along_x.share(column), along_y.share(row));
    }
  }
  for (std::size_t column = along_x.first(); column < along_x.end(); ++column) {
    const Term line = along_y.line([&](std::size_t i) { return cell(i, column); });
    add_product(sum, 1, along_x.share(column), line);
  }
  return sum;
}

}  // namespace waymark
