#include "core/detect/cell_reader.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "core/geometry/square_homography.h"

namespace waymark {
namespace {

/// Grey value of the nearest pixel; nullopt outside the image.
std::optional<double> grey_at(const GrayView& image, const Eigen::Vector2d& pixel) {
  const double x = std::round(pixel.x());
  const double y = std::round(pixel.y());
  if (!(x >= 0 && y >= 0 && x < image.width_px && y < image.height_px)) return std::nullopt;
  return image.row(static_cast<int>(y))[static_cast<int>(x)];
}

/// Mean of five samples around the middle of a cell.
std::optional<double> cell_grey(const GrayView& image, const Eigen::Matrix3d& pixel_from_unit,
                                int cells, int row, int column) {
  constexpr std::array<std::array<double, 2>, 5> kSamples{
      {{0.5, 0.5}, {0.35, 0.35}, {0.65, 0.35}, {0.35, 0.65}, {0.65, 0.65}}};
  double sum = 0;
  for (const auto& [right, down] : kSamples) {
    const Eigen::Vector3d unit((column + right) / cells, (row + down) / cells, 1);
    const auto grey = grey_at(image, (pixel_from_unit * unit).hnormalized());
    if (!grey) return std::nullopt;
    sum += *grey;
  }
  return sum / kSamples.size();
}

/// All that are printed, row by row, while `use` is true.
template <typename Use>
bool for_each_cell(const MarkerBits& bits, const Use& use) {
  const int end = bits.cells + bits.outside;
  for (int row = -bits.outside; row < end; ++row) {
    for (int column = -bits.outside; column < end; ++column) {
      if (bits.kind(row, column) == CellKind::nothing) continue;
      if (!use(row, column)) return false;
    }
  }
  return true;
}

}  // namespace

std::optional<CellReading> read_cells(const GrayView& image, const ImageCorners& corners,
                                      const MarkerBits& bits) {
  const auto pixel_from_unit = homography_from_unit_square(corners);
  if (!pixel_from_unit) return std::nullopt;
  std::array<double, kMaxMarkerCells * kMaxMarkerCells> greys;
  std::size_t read = 0;
  std::array<double, 2> sums{};
  std::array<int, 2> counts{};
  const bool all_read = for_each_cell(bits, [&](int row, int column) {
    const auto grey = cell_grey(image, *pixel_from_unit, bits.cells, row, column);
    if (!grey) return false;
    const std::size_t color = bits.is_white(row, column) ? 1 : 0;
    sums[color] += *grey;
    ++counts[color];
    greys[read++] = *grey;
    return true;
  });
  if (!all_read || counts[0] == 0 || counts[1] == 0) return std::nullopt;
  const double black = sums[0] / counts[0];
  const double white = sums[1] / counts[1];

  CellReading reading;
  reading.contrast_grey = white - black;
  std::size_t cell = 0;
  for_each_cell(bits, [&](int row, int column) {
    const bool is_white = greys[cell++] > 0.5 * (black + white);
    const bool wrong = is_white != bits.is_white(row, column);
    if (bits.kind(row, column) == CellKind::code) {
      reading.wrong_code_cells += wrong ? 1 : 0;
    } else {
      ++reading.other_cells;
      reading.wrong_other_cells += wrong ? 1 : 0;
    }
    return true;
  });
  return reading;
}

}  // namespace waymark
