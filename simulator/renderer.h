#pragma once

#include <cstdint>
#include <vector>

#include "core/camera/rig.h"
#include "simulator/camera_motion.h"
#include "simulator/illumination.h"
#include "simulator/marker_print.h"
#include "simulator/point_spread.h"
#include "simulator/ray_table.h"
#include "simulator/render_settings.h"
#include "simulator/scene.h"
#include "simulator/sensor.h"
#include "simulator/wall_texture.h"

namespace waymark::simulator {

/// Renders what the cameras of a rig see of a scene. Const calls may run on several threads; an
/// image depends on its arguments only. The scene must outlive it.
class Renderer {
 public:
  /// `threads` for the one-time preparation of each camera's directions.
  Renderer(const Scene& scene, const Rig& rig, const RenderSettings& settings, int threads);

  /// The finished 8-bit image of a camera (an index into the rig).
  [[nodiscard]] GrayImage render(std::size_t camera, const CameraMotion& motion,
                                 std::uint64_t noise_seed) const;

  /// The light behind it, after lens and pixel aperture, before vignetting and noise.
  [[nodiscard]] IrradianceImage irradiance(std::size_t camera, const CameraMotion& motion) const;

  /// What all tiles of all images share; see tile_painter.h.
  struct Stage {
    const Scene* scene;
    RenderSettings settings;
    WallTexture texture;
    Illumination illumination;
    std::vector<MarkerPrint> prints;  ///< per marker of the scene
    std::vector<float> albedo_by_surface;
    std::vector<Rigid3> world_from_surface;
  };

 private:
  Stage stage_;
  std::vector<CameraModel> models_;
  std::vector<RayTable> rays_;
  PointSpread plain_;  ///< for tiles without edges: one sample per pixel
  PointSpread fine_;
  Sensor sensor_;
};

}  // namespace waymark::simulator
