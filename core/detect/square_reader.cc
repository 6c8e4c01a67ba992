#include "core/detect/square_reader.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/base/check.h"
#include "core/detect/code_table.h"
#include "core/geometry/square_homography.h"
#include "core/marker/marker_codes.h"
#include "core/marker/marker_layout.h"

namespace waymark {

/// The square's pixels by their place in it: (0, 0) … (1, 1).
class SquarePixels {
 public:
  SquarePixels(const GrayView& image, const Eigen::Matrix3d& pixel_from_unit)
      : image_(image), pixel_from_unit_(pixel_from_unit) {}

  /// Grey value of the nearest pixel; at the image's edge that of the edge.
  [[nodiscard]] double at(double right, double down) const {
    const Eigen::Vector2d pixel =
        (pixel_from_unit_ * Eigen::Vector3d(right, down, 1)).hnormalized();
    const int x = std::clamp(static_cast<int>(std::lround(std::clamp(pixel.x(), -1e6, 1e6))), 0,
                             image_.width_px - 1);
    const int y = std::clamp(static_cast<int>(std::lround(std::clamp(pixel.y(), -1e6, 1e6))), 0,
                             image_.height_px - 1);
    return image_.row(y)[x];
  }

  /// Mean over five places of a code's cell within a border: its middle, and four that lie `off`
  /// (cells) from it to both sides.
  [[nodiscard]] double cell(int cells, double border, double row, double column,
                            double off = 0.2) const {
    const double all = cells + 2 * border;
    const double right = border + column + 0.5;
    const double down = border + row + 0.5;
    double sum = at(right / all, down / all);
    for (const double x : {right - off, right + off}) {
      for (const double y : {down - off, down + off}) sum += at(x / all, y / all);
    }
    return sum / 5;
  }

 private:
  const GrayView& image_;
  Eigen::Matrix3d pixel_from_unit_;
};

namespace {

constexpr std::array kRepresentatives{
    Family::aruco_4x4_1000, Family::aruco_5x5_1000, Family::aruco_6x6_1000, Family::aruco_7x7_1000,
    Family::aruco_original, Family::tag16h5,        Family::tag25h9,        Family::tag36h10,
    Family::tag36h11,       Family::aruco_mip_36h12};

constexpr int kFewestCells = 4;
constexpr int kMostCells = 7;

/// A code as a grid that is turned and mirrored as one number.
class Grid {
 public:
  Grid(std::uint64_t bits, int cells) : bits_(bits), cells_(cells) {}
  [[nodiscard]] std::uint64_t bits() const { return bits_; }
  [[nodiscard]] bool at(int row, int column) const {
    return ((bits_ >> (row * cells_ + column)) & 1U) != 0;
  }
  /// As seen when the square's next corner is taken for the first.
  [[nodiscard]] Grid turned() const {
    return made([&](int row, int column) { return at(column, cells_ - 1 - row); });
  }
  [[nodiscard]] Grid mirrored() const {
    return made([&](int row, int column) { return at(row, cells_ - 1 - column); });
  }

 private:
  template <typename At>
  [[nodiscard]] Grid made(const At& at) const {
    std::uint64_t bits = 0;
    for (int row = 0; row < cells_; ++row) {
      for (int column = 0; column < cells_; ++column) {
        if (at(row, column)) bits |= std::uint64_t{1} << (row * cells_ + column);
      }
    }
    return {bits, cells_};
  }
  std::uint64_t bits_;
  int cells_;
};

/// Brightest of many places on the rim, `depth` (of the side) inside the outline.
double brightest_rim(const SquarePixels& pixels, double depth) {
  constexpr int kSteps = 24;
  std::vector<double> greys;
  for (int i = 0; i < kSteps; ++i) {
    const double along = depth + (1 - 2 * depth) * i / (kSteps - 1);
    for (const auto& [right, down] : {std::pair{along, depth}, std::pair{along, 1 - depth},
                                      std::pair{depth, along}, std::pair{1 - depth, along}}) {
      greys.push_back(pixels.at(right, down));
    }
  }
  // A tenth may be a reflection, a finger, a corner that is off.
  const auto most = greys.begin() + static_cast<std::ptrdiff_t>(greys.size() * 9 / 10);
  std::nth_element(greys.begin(), most, greys.end());
  return *most;
}

/// The code's cells at a border's width: white ones as bits; nullopt without a dark rim or
/// contrast.
std::optional<std::uint64_t> code_of(const SquarePixels& pixels, int cells, double border) {
  constexpr double kLeastContrast = 20;  // grey values
  std::array<double, kMostCells * kMostCells> greys;
  std::size_t count = 0;
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      greys[count++] = pixels.cell(cells, border, row, column);
    }
  }
  const auto [darkest, brightest] = std::minmax_element(greys.begin(), greys.begin() + count);
  const double rim = brightest_rim(pixels, 0.5 * border / (cells + 2 * border));
  const double threshold = 0.5 * (std::min(*darkest, rim) + *brightest);
  if (*brightest - std::min(*darkest, rim) < kLeastContrast || rim > threshold) return std::nullopt;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (greys[i] > threshold) bits |= std::uint64_t{1} << i;
  }
  return bits;
}

/// How clearly the square shows a code at a border's width.
double clearness(const SquarePixels& pixels, const Grid& seen, int cells, double border) {
  // Near the cells' edges: a width that is off a little takes samples to other cells.
  constexpr double kOff = 0.4;
  std::array<double, 2> sums{};
  std::array<int, 2> counts{};
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      const std::size_t white = seen.at(row, column) ? 1 : 0;
      sums[white] += pixels.cell(cells, border, row, column, kOff);
      ++counts[white];
    }
  }
  if (counts[0] == 0 || counts[1] == 0) return 0;
  return sums[1] / counts[1] - sums[0] / counts[0];
}

/// The border's width at which the code shows most clearly.
double measured_border(const SquarePixels& pixels, const Grid& seen, int cells) {
  constexpr double kStep = 0.05;
  double sum = 0;
  double weights = 0;
  std::vector<std::pair<double, double>> tried;
  double most = 0;
  for (double border = 0.1; border < 2.6; border += kStep) {
    tried.emplace_back(border, clearness(pixels, seen, cells, border));
    most = std::max(most, tried.back().second);
  }
  // Of some widths all samples lie in their cells: the middle of these.
  for (const auto& [border, clear] : tried) {
    if (clear < 0.97 * most) continue;
    sum += border;
    weights += 1;
  }
  return weights > 0 ? sum / weights : 1;
}

int code_cells(Family family) { return marker_layout(family).square_cells() - 2; }

}  // namespace

SquareReader::SquareReader() {
  for (const Family family : kRepresentatives) {
    Codes codes{family, code_cells(family), correctable_bits(family), {}};
    for (int number = 0; number < traits(family).id_count; ++number) {
      codes.codes.push_back(marker_code({family, number}));
    }
    families_.push_back(std::move(codes));
  }
}

std::span<const Family> SquareReader::families() { return kRepresentatives; }

bool SquareLook::could_show(const SquareForm& form) const {
  const std::uint8_t cells = form.other_border ? cells_of_other_border : cells_of_usual_border;
  return ((cells >> code_cells(form.family)) & 1U) != 0;
}

double SquareReader::chance_of(const SquareForm& form, bool exact) const {
  const auto found = std::find_if(families_.begin(), families_.end(),
                                  [&](const Codes& codes) { return codes.family == form.family; });
  WAYMARK_CHECK(found != families_.end());
  const int bits = found->cells * found->cells;
  double patterns = 1;
  double combinations = 1;
  for (int wrong = 1; wrong <= (exact ? 0 : found->corrected); ++wrong) {
    combinations *= static_cast<double>(bits - wrong + 1) / wrong;
    patterns += combinations;
  }
  const int borders = form.other_border ? 2 : 1;
  return std::min(
      1.0, borders * 4.0 * static_cast<double>(found->codes.size()) * patterns / std::exp2(bits));
}

/// Adds what a grid of cells reads as, any way up.
void SquareReader::decode(std::uint64_t bits, int cells, bool mirrored,
                          std::vector<SquareReading>& readings) const {
  Grid turned(bits, cells);
  if (mirrored) turned = turned.mirrored();
  for (int turn = 0; turn < 4; ++turn, turned = turned.turned()) {
    for (const Codes& family : families_) {
      if (family.cells != cells) continue;
      for (std::size_t number = 0; number < family.codes.size(); ++number) {
        const int wrong = std::popcount(family.codes[number] ^ turned.bits());
        if (wrong > family.corrected) continue;
        SquareReading reading;
        reading.form = {family.family, mirrored, false};
        reading.number = static_cast<int>(number);
        reading.wrong_bits = wrong;
        // Mirrored, the corners run the other way round from the second.
        reading.first_corner = mirrored ? (5 - turn) % 4 : turn;
        readings.push_back(reading);
      }
    }
  }
}

/// Adds what the square shows at one width of the border.
void SquareReader::read_at(const SquarePixels& pixels, int cells, double border,
                           SquareLook& look) const {
  // Blur and bloom move the outline by less.
  constexpr double kSameBorder = 0.3;  // cells
  const auto code = code_of(pixels, cells, border);
  if (!code) return;
  auto& could = border == 1.0 ? look.cells_of_usual_border : look.cells_of_other_border;
  could = static_cast<std::uint8_t>(could | (1U << cells));
  std::vector<SquareReading> readings;
  decode(*code, cells, false, readings);
  decode(*code, cells, true, readings);
  if (readings.empty()) return;
  const double width = measured_border(pixels, Grid(*code, cells), cells);
  for (SquareReading& reading : readings) {
    reading.border_cells = width;
    reading.form.other_border = std::abs(width - 1) > kSameBorder;
    const bool known =
        std::any_of(look.readings.begin(), look.readings.end(),
                    [&](const SquareReading& one) { return one.form == reading.form; });
    if (!known) look.readings.push_back(reading);
  }
}

SquareLook SquareReader::read(const GrayView& image, const ImageCorners& square) const {
  SquareLook look;
  const auto pixel_from_unit = homography_from_unit_square(square);
  if (!pixel_from_unit) return look;
  const SquarePixels pixels(image, *pixel_from_unit);
  for (const double border : {1.0, 2.0, 0.5}) {
    for (int cells = kFewestCells; cells <= kMostCells; ++cells) {
      read_at(pixels, cells, border, look);
    }
  }
  return look;
}

SquareLook SquareReader::read_inside(const GrayView& image, const ImageCorners& code_area) const {
  SquareLook look;
  const Eigen::Vector2d centre = 0.25 * (code_area[0] + code_area[1] + code_area[2] + code_area[3]);
  for (int cells = kFewestCells; cells <= kMostCells; ++cells) {
    ImageCorners outline = code_area;
    for (Eigen::Vector2d& corner : outline)
      corner = centre + (corner - centre) * (cells + 2) / cells;
    const auto pixel_from_unit = homography_from_unit_square(outline);
    if (pixel_from_unit) read_at(SquarePixels(image, *pixel_from_unit), cells, 1.0, look);
  }
  return look;
}

}  // namespace waymark
