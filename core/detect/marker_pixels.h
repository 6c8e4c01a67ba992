#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/capture/gray_image.h"
#include "core/detect/blurred_marker.h"
#include "core/detect/marker_plane.h"
#include "core/marker/marker_bits.h"
#include "core/marker/marker_geometry.h"

namespace waymark {

/// What a marker's image depends on but for its light: the corners (px, x0 y0 … x3 y3), ln of the
/// lens's blur as a variance (px²), how much more of that lies along x than y, and along the
/// diagonal (shares), and the growth of white (px).
using MarkerShape = Eigen::Matrix<double, 12, 1>;
inline constexpr Eigen::Index kShapeBlur = 8;
inline constexpr Eigen::Index kShapeGrowth = 11;

[[nodiscard]] ImageCorners corners_of(const MarkerShape& shape);
[[nodiscard]] MarkerShape shape_at(const ImageCorners& corners, double blur_px);

/// A pixel of a marker or of the paper around it.
struct MarkerPixel {
  Eigen::Vector2d plane;          ///< in the marker's plane
  Eigen::Matrix2d plane_from_px;  ///< derivative
  double grey = 0;                ///< 0 black, 1 white
  /// 1 x y x² xy y² of its place about the start's centre, ± 0.5 within the start: what light that
  /// varies over the marker is made of.
  Eigen::Matrix<double, 6, 1> place;
};

/// How white a pixel is by a shape, and how that changes with the shape's numbers.
struct PixelWhiteness {
  double value = 0;
  MarkerShape by_shape = MarkerShape::Zero();
};

/// The pixels by which a marker is fitted, of those within it and 0.55 cells around: at most 600 at
/// the edges of its cells, which tell where it is, and 200 of the others, which tell its light,
/// both drawn with a fixed seed; none is interpolated.
class MarkerPixels {
 public:
  /// Around `corners`, the start. Nothing is taken where the lens or the image does not reach.
  MarkerPixels(const GrayView& image, const CameraModel& camera, const ImageCorners& corners,
               const MarkerBits& bits);

  [[nodiscard]] const ImageCorners& start() const { return start_; }
  [[nodiscard]] const std::vector<MarkerPixel>& all() const { return pixels_; }

  /// How white each pixel is by a shape, into `whiteness` (resized). False where the shape's
  /// corners lie on a line or the lens does not see them.
  [[nodiscard]] bool look(const MarkerShape& shape, std::vector<PixelWhiteness>& whiteness) const;

 private:
  class CellMap;
  /// Pixels that see an edge, and those that do not.
  struct Places {
    std::vector<Eigen::Vector2i> edges;
    std::vector<Eigen::Vector2i> rest;
  };
  [[nodiscard]] std::optional<CellMap> map_of(const ImageCorners& corners) const;
  [[nodiscard]] Places around(const GrayView& image) const;
  void add(const GrayView& image, const CellMap& map, const Eigen::Vector2i& pixel);

  ImageCorners start_;
  double cells_;
  BlurredMarker marker_;
  std::optional<MarkerPlane> plane_;
  std::vector<MarkerPixel> pixels_;
};

}  // namespace waymark
