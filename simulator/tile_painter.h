#pragma once

#include <cstdint>
#include <vector>

#include "simulator/camera_view.h"
#include "simulator/plate_painter.h"
#include "simulator/renderer.h"
#include "simulator/surface_patch.h"
#include "simulator/tile_rays.h"

namespace waymark::simulator {

/// Paints tiles: ideal light at sub-pixels over the tile and the apron that the point spread draws
/// from, then the point spread. Keeps its memory from tile to tile; one painter per thread.
class TilePainter {
 public:
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
    MovingPlane plane;
    float width_m, height_m;
    bool covers;  ///< the whole tile and apron
  };

  [[nodiscard]] SubpixelGrid grid_of(const Tile& tile, int oversampling) const;
  void find_candidates(const Tile& apron, const CameraView& view);
  void find_plates(const SubpixelGrid& grid, const CameraView& view);
  void paint_view(const SubpixelGrid& grid, const CameraView& view, float weight);
  void find_seen(const SubpixelGrid& grid, float share);
  void paint_surfaces(const SubpixelGrid& grid, std::size_t row);
  void reduce(const Tile& tile, const SubpixelGrid& grid, const PointSpread& spread,
              IrradianceImage& out);
  [[nodiscard]] float share_at(double row_px) const;
  /// One surface fills the view: nobody need ask what is seen where.
  [[nodiscard]] bool one_surface() const {
    return candidates_.size() == 1 && candidates_.front().covers;
  }

  const Renderer::Stage& stage_;
  const RayTable& rays_;
  int radius_px_;
  double band_first_px_ = 0, band_last_px_ = 0;

  std::vector<Candidate> candidates_;
  std::vector<SurfacePatch> patches_;  ///< of the candidates
  std::vector<PlatePainter> plates_;
  CornerRays upper_, lower_;
  // Rows of sub-pixels, phase by phase.
  std::vector<std::int32_t> seen_;  ///< which candidate, or kNothing
  std::vector<float> centre_x_, centre_y_, centre_z_, nearness_, albedo_, light_, patch_albedo_,
      patch_light_;
  std::vector<float> canvas_;  ///< all rows
  std::vector<float> half_reduced_;
};

}  // namespace waymark::simulator
