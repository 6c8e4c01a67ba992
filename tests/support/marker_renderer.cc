#include "tests/support/marker_renderer.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/base/check.h"
#include "core/geometry/decompositions.h"
#include "core/marker/marker_bits.h"
#include "tests/support/coverage_grid.h"

namespace waymark::testing {
namespace {

constexpr int kOversampling = 6;
/// Pieces of a cell's edge: a lens bends it.
constexpr int kPiecesPerCell = 12;

/// The marker's plane (cells right and down from the top-left corner) in the image.
class CellProjector {
 public:
  CellProjector(const CameraModel& camera, const RenderedMarker& marker, int cells)
      : camera_(camera), marker_(marker), cells_(cells) {}

  [[nodiscard]] Eigen::Vector2d operator()(double column, double row) const {
    const double cell_m = marker_.size_m / cells_;
    const Eigen::Vector3d x_in_marker(column * cell_m - 0.5 * marker_.size_m,
                                      0.5 * marker_.size_m - row * cell_m, 0);
    const auto pixel = camera_.project(marker_.cam_from_marker * x_in_marker);
    WAYMARK_CHECK(pixel.has_value());
    return *pixel;
  }

  /// Outline, clockwise, of the square from (column, row), `side` cells wide.
  [[nodiscard]] std::vector<Eigen::Vector2d> outline(double column, double row, double side) const {
    const int pieces = kPiecesPerCell * std::max(1, static_cast<int>(std::lround(side)));
    std::vector<Eigen::Vector2d> points;
    for (int edge = 0; edge < 4; ++edge) {
      for (int i = 0; i < pieces; ++i) {
        const double along = side * i / pieces;
        const double back = side - along;
        points.push_back(edge == 0   ? (*this)(column + along, row)
                         : edge == 1 ? (*this)(column + side, row + along)
                         : edge == 2 ? (*this)(column + back, row + side)
                                     : (*this)(column, row + back));
      }
    }
    return points;
  }

 private:
  const CameraModel& camera_;
  const RenderedMarker& marker_;
  int cells_;
};

/// Pixels that a marker's paper and its blur touch; may reach over the image's edge.
PixelBox box_around(const std::vector<Eigen::Vector2d>& outline, double margin_px) {
  Eigen::Vector2d low = outline.front();
  Eigen::Vector2d high = outline.front();
  for (const Eigen::Vector2d& point : outline) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  return {static_cast<int>(std::floor(low.x() - margin_px)),
          static_cast<int>(std::floor(low.y() - margin_px)),
          static_cast<int>(std::ceil(high.x() + margin_px)),
          static_cast<int>(std::ceil(high.y() + margin_px))};
}

/// Adds the marker's light, less the background's, to `light`.
void add_marker(const CameraModel& camera, const RenderedMarker& marker,
                const RenderOptions& options, int width_px, std::vector<double>& light) {
  const MarkerBits bits = marker_bits(marker.id);
  const CellProjector project(camera, marker, bits.cells);
  const double around = bits.outside + marker.quiet_zone_cells;
  const auto paper = project.outline(-around, -around, bits.cells + 2 * around);
  CoverageGrid grid(box_around(paper, 4 * options.psf_sigma_px + 2), kOversampling);
  grid.add(paper, marker.white - options.background);
  const int first = -bits.outside;
  grid.add(project.outline(first, first, bits.all_cells()), marker.black - marker.white);
  for (int row = first; row < bits.cells + bits.outside; ++row) {
    for (int column = first; column < bits.cells + bits.outside; ++column) {
      if (bits.is_white(row, column) || bits.kind(row, column) == CellKind::nothing) {
        grid.add(project.outline(column, row, 1), marker.white - marker.black);
      }
    }
  }
  grid.integrate_into(options.psf_sigma_px, width_px, light);
}

double srgb_response(double light) {
  const double x = std::clamp(light / 255, 0.0, 1.0);
  return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055);
}

/// A soft shadow's depth, 0…1, at a place in penumbra widths from its middle.
double shade(double place) {
  const double s = std::clamp(place + 0.5, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

}  // namespace

GrayImage render_markers(const CameraModel& camera, std::span<const RenderedMarker> markers,
                         const RenderOptions& options) {
  const int width = camera.parameters().width_px;
  const int height = camera.parameters().height_px;
  std::vector<double> light(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                            options.background);
  for (const RenderedMarker& marker : markers) add_marker(camera, marker, options, width, light);

  std::mt19937_64 generator(options.seed);
  std::normal_distribution<double> noise(0, 1);
  GrayImage image(width, height);
  for (std::size_t i = 0; i < light.size(); ++i) {
    const double x = static_cast<double>(i % static_cast<std::size_t>(width)) / width - 0.5;
    const double lit = light[i] * (1 + options.gradient_grey * x / 255) *
                       (1 - options.shadow_share * shade(x * width / options.penumbra_px));
    const double response = options.srgb ? srgb_response(lit) : lit;
    const double grey = response + options.noise_grey * noise(generator);
    image.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
  }
  return image;
}

ImageCorners true_corners(const CameraModel& camera, const RenderedMarker& marker) {
  ImageCorners corners;
  const auto x_in_marker = marker_corners(marker.size_m);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = camera.project(marker.cam_from_marker * x_in_marker[i]);
    WAYMARK_CHECK(pixel.has_value());
    corners[i] = *pixel;
  }
  return corners;
}

Rigid3 pose_seen_as(const CameraModel& camera, const MarkerView& view, double size_m) {
  const auto bearing = camera.bearing(view.center_px);
  WAYMARK_CHECK(bearing.has_value());
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  const Eigen::Quaterniond facing(Eigen::Matrix3d(Vector3d(1, -1, -1).asDiagonal()));
  RenderedMarker marker;
  marker.size_m = size_m;
  marker.cam_from_marker.rotation =
      (shortest_rotation(Vector3d::UnitZ(), *bearing) *
       AngleAxisd(view.azimuth_rad, Vector3d::UnitZ()) *
       AngleAxisd(view.tilt_rad, Vector3d::UnitX()) *
       AngleAxisd(view.roll_rad - view.azimuth_rad, Vector3d::UnitZ()) * facing)
          .normalized();
  double distance_m = camera.parameters().fu_px * size_m / view.mean_side_px;
  for (int i = 0; i < 20; ++i) {
    marker.cam_from_marker.translation = distance_m * *bearing;
    distance_m *= mean_side_px(true_corners(camera, marker)) / view.mean_side_px;
  }
  return marker.cam_from_marker;
}

}  // namespace waymark::testing
