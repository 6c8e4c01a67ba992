#include "core/detect/marker_pixels.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/geometry/square_homography.h"
#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

constexpr std::size_t kMostAtEdges = 600;
constexpr std::size_t kMostOfRest = 200;
/// Cells of paper around the marker that are looked at.
constexpr double kMargin = 0.55;
/// By which corners are moved for derivatives (px): far above rounding, far below a lens's bend.
constexpr double kCornerStep_px = 0.01;

/// The first `most` of the places in an order that is drawn with a fixed seed.
void draw(std::size_t most, std::vector<Eigen::Vector2i>& places) {
  if (places.size() <= most) return;
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i < most; ++i) {
    std::swap(places[i], places[i + random() % (places.size() - i)]);
  }
  places.resize(most);
}

/// Standard deviation (px) of the lens's blur in a direction, with derivatives by the shape's three
/// numbers of blur.
double blur_across(const MarkerShape& shape, const Eigen::Vector2d& across, Eigen::Vector3d& d) {
  constexpr double kLeast = 0.01;
  const double variance = std::exp(shape[kShapeBlur]);
  const double along_x = across.x() * across.x() - across.y() * across.y();
  const double diagonal = 2 * across.x() * across.y();
  const double share = 1 + shape[kShapeBlur + 1] * along_x + shape[kShapeBlur + 2] * diagonal;
  const double blur = std::sqrt(variance * std::max(kLeast, share));
  d << blur / 2, variance * along_x / (2 * blur), variance * diagonal / (2 * blur);
  return blur;
}

}  // namespace

ImageCorners corners_of(const MarkerShape& shape) {
  ImageCorners corners;
  for (Eigen::Index i = 0; i < 4; ++i) {
    corners[static_cast<std::size_t>(i)] = shape.segment<2>(2 * i);
  }
  return corners;
}

MarkerShape shape_at(const ImageCorners& corners, double blur_px) {
  MarkerShape shape = MarkerShape::Zero();
  for (Eigen::Index i = 0; i < 4; ++i) {
    shape.segment<2>(2 * i) = corners[static_cast<std::size_t>(i)];
  }
  shape[kShapeBlur] = 2 * std::log(blur_px);
  return shape;
}

/// Cells (x right, y down, from the top left corner) of points in the marker's plane.
class MarkerPixels::CellMap {
 public:
  static std::optional<CellMap> of(const ImageCorners& plane_corners, double cells) {
    const auto plane_from_unit = homography_from_unit_square(plane_corners);
    if (!plane_from_unit) return std::nullopt;
    Eigen::Matrix3d cells_from_plane;
    bool invertible = false;
    plane_from_unit->computeInverseWithCheck(cells_from_plane, invertible, 0.0);
    if (!invertible) return std::nullopt;
    cells_from_plane.topRows<2>() *= cells;
    return CellMap(cells_from_plane);
  }

  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector2d& plane) const {
    return (cells_from_plane_ * plane.homogeneous()).hnormalized();
  }

  /// d cells / d the map's numbers, on the way to `other`: how the cells at `plane` (at `at`)
  /// change.
  [[nodiscard]] Eigen::Vector2d change(const CellMap& other, const Eigen::Vector2d& plane,
                                       const Eigen::Vector2d& at) const {
    const Eigen::Vector3d h = (other.cells_from_plane_ - cells_from_plane_) * plane.homogeneous();
    return (h.head<2>() - at * h.z()) / cells_from_plane_.row(2).dot(plane.homogeneous());
  }

  /// d cells / d plane.
  [[nodiscard]] Eigen::Matrix2d slope(const Eigen::Vector2d& plane) const {
    const Eigen::Vector3d h = cells_from_plane_ * plane.homogeneous();
    return (cells_from_plane_.topLeftCorner<2, 2>() -
            h.hnormalized() * cells_from_plane_.bottomLeftCorner<1, 2>()) /
           h.z();
  }

 private:
  explicit CellMap(const Eigen::Matrix3d& cells_from_plane) : cells_from_plane_(cells_from_plane) {}
  Eigen::Matrix3d cells_from_plane_;
};

MarkerPixels::MarkerPixels(const GrayView& image, const CameraModel& camera,
                           const ImageCorners& corners, const MarkerBits& bits)
    : start_(corners), cells_(bits.cells), marker_(bits) {
  const auto axis = camera.bearing(centre_of(corners));
  if (!axis) return;
  plane_.emplace(camera, *axis);
  const auto map = map_of(corners);
  if (!map) return;
  Places places = around(image);
  draw(kMostAtEdges, places.edges);
  draw(kMostOfRest, places.rest);
  for (const Eigen::Vector2i& place : places.edges) add(image, *map, place);
  for (const Eigen::Vector2i& place : places.rest) add(image, *map, place);
}

std::optional<MarkerPixels::CellMap> MarkerPixels::map_of(const ImageCorners& corners) const {
  ImageCorners in_plane;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto point = plane_->plane_from_pixel(corners[i]);
    if (!point) return std::nullopt;
    in_plane[i] = *point;
  }
  return CellMap::of(in_plane, cells_);
}

/// Pixels of the image within the start and its margin; the lens's bend within the marker is
/// neglected, which moves that margin by less than a pixel.
MarkerPixels::Places MarkerPixels::around(const GrayView& image) const {
  Places places;
  const auto map = CellMap::of(start_, cells_);
  if (!map) return places;
  constexpr double kNear_px = 2.0;
  constexpr double kLeastCells = 0.25;  // large cells are often seen out of focus
  constexpr double kMostCells = 0.5;
  const double reach =
      std::clamp(kNear_px * cells_ / std::sqrt(area_px2(start_)), kLeastCells, kMostCells);
  Eigen::Vector2d low = start_[0];
  Eigen::Vector2d high = start_[0];
  for (const Eigen::Vector2d& corner : start_) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(1.0) + (high - low) * 2 / cells_;
  const auto from = [](double value) { return std::max(0, static_cast<int>(value)); };
  const int x_end = std::min(image.width_px - 1, from(high.x() + margin.x()));
  const int y_end = std::min(image.height_px - 1, from(high.y() + margin.y()));
  for (int y = from(low.y() - margin.y()); y <= y_end; ++y) {
    for (int x = from(low.x() - margin.x()); x <= x_end; ++x) {
      const Eigen::Vector2d at = map->at(Eigen::Vector2d(x, y));
      if (!(at.minCoeff() >= -kMargin && at.maxCoeff() <= cells_ + kMargin)) continue;
      (marker_.has_edge_near(at, reach) ? places.edges : places.rest).emplace_back(x, y);
    }
  }
  return places;
}

void MarkerPixels::add(const GrayView& image, const CellMap& map, const Eigen::Vector2i& pixel) {
  const auto plane = plane_->plane_from_pixel(pixel.cast<double>());
  if (!plane) return;
  const auto px_from_plane = plane_->pixel_slope(*plane);
  if (!px_from_plane) return;
  Eigen::Matrix2d plane_from_px;
  bool invertible = false;
  px_from_plane->computeInverseWithCheck(plane_from_px, invertible);
  if (!invertible) return;
  const Eigen::Vector2d x = map.at(*plane) / cells_ - Eigen::Vector2d::Constant(0.5);
  MarkerPixel added{*plane, plane_from_px, image.row(pixel.y())[pixel.x()] / 255.0, {}};
  added.place << 1, x.x(), x.y(), x.x() * x.x(), x.x() * x.y(), x.y() * x.y();
  pixels_.push_back(added);
}

bool MarkerPixels::look(const MarkerShape& shape, std::vector<PixelWhiteness>& whiteness) const {
  whiteness.resize(pixels_.size());
  if (pixels_.empty()) return false;
  const ImageCorners corners = corners_of(shape);
  const auto map = map_of(corners);
  if (!map) return false;
  std::array<std::optional<CellMap>, 8> moved;
  for (std::size_t i = 0; i < 8; ++i) {
    ImageCorners other = corners;
    other[i / 2][static_cast<Eigen::Index>(i % 2)] += kCornerStep_px;
    moved[i] = map_of(other);
    if (!moved[i]) return false;
  }
  for (std::size_t n = 0; n < pixels_.size(); ++n) {
    const MarkerPixel& pixel = pixels_[n];
    const Eigen::Vector2d at = map->at(pixel.plane);
    const Eigen::Matrix2d slope = map->slope(pixel.plane) * pixel.plane_from_px;
    std::array<AxisView, 2> views;
    std::array<Eigen::Vector3d, 2> d_blur;
    for (int axis = 0; axis < 2; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double cells_per_px = slope.row(axis).norm();
      const Eigen::Vector2d across = slope.row(axis).transpose() / cells_per_px;
      views[a] = {at[axis], cells_per_px, blur_across(shape, across, d_blur[a])};
    }
    const Whiteness w = marker_.at(views[0], views[1], shape[kShapeGrowth]);
    whiteness[n].value = w.value;
    MarkerShape& d = whiteness[n].by_shape;
    for (std::size_t i = 0; i < 8; ++i) {
      d[static_cast<Eigen::Index>(i)] =
          w.d_place.dot(map->change(*moved[i], pixel.plane, at)) / kCornerStep_px;
    }
    d.segment<3>(kShapeBlur) = w.d_blur.x() * d_blur[0] + w.d_blur.y() * d_blur[1];
    d[kShapeGrowth] = w.d_growth;
  }
  return true;
}

}  // namespace waymark
