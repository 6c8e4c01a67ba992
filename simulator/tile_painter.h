#pragma once

#include <cstdint>
#include <vector>

#include "simulator/camera_view.h"
#include "simulator/renderer.h"

namespace waymark::simulator {

/// A rectangle of the image that is rendered at once (px).
struct Tile {
  int x0, y0;
  int width, height;
};

/// Paints tiles: ideal light at sub-pixels over the tile and the apron that the point spread draws
/// from, then the point spread. Keeps its memory from tile to tile; one painter per thread.
class TilePainter {
 public:
  /// Band rows first_row … last_row (px) are those that a view's moving planes move between.
  TilePainter(const Renderer::Stage& stage, const RayTable& rays, int radius_px);

  /// Whether all that the tile sees is one surface without markers: one sample per pixel will do.
  [[nodiscard]] bool is_plain(const Tile& tile, const std::vector<CameraView>& views);

  /// Averages the views (sub-exposures) of a tile through the point spread into `out`. A view's
  /// planes are at their `first` at image row `band_first_px` and at their `last` at
  /// `band_last_px`.
  void paint(const Tile& tile, const std::vector<CameraView>& views, double band_first_px,
             double band_last_px, const PointSpread& spread, IrradianceImage& out);

 private:
  /// A surface that may be seen in the tile.
  struct Candidate {
    int surface;
    MovingPlane plane;
    float width_m, height_m;
    bool covers;  ///< the whole tile and apron
    std::size_t texture_level;
    std::vector<float> light;  ///< at the nodes of a coarse grid over tile and apron
  };
  /// A marker in the tile, with the plate coordinates of sub-pixel corners in two neighbouring
  /// rows.
  struct Plate {
    const MarkerPrint* print;
    MovingPlane plane;
    int surface;
    std::size_t begin, end;   ///< sub-pixel columns
    int first_row, last_row;  ///< sub-pixel rows
    std::vector<float> upper_x, upper_y, lower_x, lower_y;
  };
  struct RayRow {
    std::vector<float> x, y, z;
    void resize(std::size_t n) {
      x.resize(n);
      y.resize(n);
      z.resize(n);
    }
  };

  void find_candidates(const Tile& tile, const CameraView& view);
  void find_plates(const Tile& tile, const CameraView& view, int n);
  void light_candidates(const Tile& tile, int n);
  void paint_view(const Tile& tile, const CameraView& view, int n, float weight);
  void corner_rays(const Tile& tile, int n, std::size_t row, RayRow& out);
  void choose_surfaces(std::size_t columns, float share);
  void paint_surfaces(std::size_t row, std::size_t columns, int n, float share);
  void paint_plate(Plate& plate, std::size_t row, float share);
  void plate_corners(Plate& plate, float share) const;

  const Renderer::Stage& stage_;
  const RayTable& rays_;
  int radius_px_;
  double band_first_px_ = 0, band_last_px_ = 0;

  std::vector<Candidate> candidates_;
  std::vector<Plate> plates_;
  RayRow upper_, lower_, centre_;
  std::vector<float> pixel_corners_;
  std::vector<std::uint8_t> seen_;  ///< per sub-pixel of a row: which candidate, or kNothing
  std::vector<float> nearness_;
  std::vector<float> background_, albedo_, light_;
  std::vector<float> canvas_;  ///< rows of sub-pixels, each split into its phases
  std::vector<float> half_reduced_, pixels_;
};

}  // namespace waymark::simulator
