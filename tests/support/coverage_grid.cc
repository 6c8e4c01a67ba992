#include "tests/support/coverage_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/check.h"

namespace waymark::testing {
namespace {

/// Weights of sub-pixels for one pixel: the point spread, sampled, over the pixel's width.
std::vector<double> pixel_kernel(double sigma_px, int oversampling) {
  const double sigma = sigma_px * oversampling;
  const int reach = static_cast<int>(std::ceil(4 * sigma));
  std::vector<double> spread;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    spread.push_back(sigma > 0 ? std::exp(-0.5 * i * i / (sigma * sigma)) : 1.0);
    sum += spread.back();
  }
  std::vector<double> kernel(spread.size() + static_cast<std::size_t>(oversampling) - 1, 0.0);
  for (std::size_t i = 0; i < spread.size(); ++i) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(oversampling); ++k) {
      kernel[i + k] += spread[i] / (sum * oversampling);
    }
  }
  return kernel;
}

/// Place of an element in rows of `width`.
std::size_t index(int row, int width, int column) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(column);
}

}  // namespace

CoverageGrid::CoverageGrid(const PixelBox& box, int oversampling)
    : box_(box),
      oversampling_(oversampling),
      columns_((box.right - box.left) * oversampling),
      rows_((box.bottom - box.top) * oversampling),
      steps_(static_cast<std::size_t>(columns_ + 2) * static_cast<std::size_t>(rows_), 0.0) {}

void CoverageGrid::add(const std::vector<Eigen::Vector2d>& polygon, double light) {
  // The pixel's centre is at integers: its left edge half a pixel before.
  const Eigen::Vector2d origin(box_.left - 0.5, box_.top - 0.5);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& next = polygon[(i + 1) % polygon.size()];
    add_edge((polygon[i] - origin) * oversampling_, (next - origin) * oversampling_, light);
  }
}

void CoverageGrid::add_edge(Eigen::Vector2d from, Eigen::Vector2d to, double light) {
  if (from.y() == to.y()) return;
  // Clockwise in an image whose y points down: left edges rise, and light starts there.
  double direction = -light;
  if (from.y() > to.y()) {
    std::swap(from, to);
    direction = light;
  }
  const double x_per_y = (to.x() - from.x()) / (to.y() - from.y());
  const int last_row = static_cast<int>(std::ceil(to.y()));
  for (int row = static_cast<int>(std::floor(from.y())); row < last_row; ++row) {
    const double y0 = std::max<double>(row, from.y());
    const double y1 = std::min<double>(row + 1, to.y());
    const double xa = from.x() + (y0 - from.y()) * x_per_y;
    const double xb = from.x() + (y1 - from.y()) * x_per_y;
    const double x0 = std::min(xa, xb);
    const double x1 = std::max(xa, xb);
    const double amount = direction * (y1 - y0);
    const int first = static_cast<int>(std::floor(x0));
    const int last = static_cast<int>(std::floor(x1));
    WAYMARK_CHECK(first >= 0 && last < columns_ && row >= 0 && row < rows_);
    double* cell = &steps_[index(row, columns_ + 2, 0)];
    // Share of the sub-pixels to the right that this piece of edge lights, as running differences.
    double before = 0;
    for (int x = first; x <= last; ++x) {
      // Mean over the piece of how much of sub-pixel x lies right of it.
      double covered;
      if (x1 - x0 < 1e-12) {
        covered = x + 1 - x0;
      } else {
        const double a = std::max<double>(x, x0);
        const double b = std::min<double>(x + 1, x1);
        const double full = std::max(0.0, a - x0);  // edge left of sub-pixel x: covered entirely
        covered = (full + (b - a) * (x + 1 - 0.5 * (a + b))) / (x1 - x0);
      }
      cell[x] += amount * (covered - before);
      before = covered;
    }
    cell[last + 1] += amount * (1 - before);
  }
}

void CoverageGrid::integrate_into(double psf_sigma_px, int width_px,
                                  std::vector<double>& image) const {
  const std::vector<double> kernel = pixel_kernel(psf_sigma_px, oversampling_);
  const int taps = static_cast<int>(kernel.size());
  const int lead = (taps - oversampling_) / 2;  // sub-pixels before the pixel's own
  const int width = box_.right - box_.left;
  const int height = box_.bottom - box_.top;
  const auto height_px = static_cast<int>(image.size() / static_cast<std::size_t>(width_px));

  const auto weighted = [&](const double* line, int length, int stride, int pixel) {
    const int start = pixel * oversampling_ - lead;
    double sum = 0;
    for (int k = std::max(0, -start); k < std::min(taps, length - start); ++k) {
      sum += kernel[static_cast<std::size_t>(k)] *
             line[static_cast<std::ptrdiff_t>(start + k) * stride];
    }
    return sum;
  };

  std::vector<double> line(static_cast<std::size_t>(columns_));
  std::vector<double> narrow(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows_));
  for (int row = 0; row < rows_; ++row) {
    const double* step = &steps_[index(row, columns_ + 2, 0)];
    double light = 0;
    for (int x = 0; x < columns_; ++x) line[static_cast<std::size_t>(x)] = light += step[x];
    for (int x = 0; x < width; ++x) {
      narrow[index(row, width, x)] = weighted(line.data(), columns_, 1, x);
    }
  }
  for (int y = std::max(0, -box_.top); y < std::min(height, height_px - box_.top); ++y) {
    for (int x = std::max(0, -box_.left); x < std::min(width, width_px - box_.left); ++x) {
      image[index(box_.top + y, width_px, box_.left + x)] +=
          weighted(narrow.data() + x, rows_, width, y);
    }
  }
}

}  // namespace waymark::testing
