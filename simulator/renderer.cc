#include "simulator/renderer.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "simulator/camera_view.h"
#include "simulator/random.h"
#include "simulator/tile_painter.h"

namespace waymark::simulator {
namespace {

constexpr int kTile_px = 64;

double blur_sigma_px(const RenderSettings& settings) {
  return std::hypot(settings.psf_sigma_px, settings.defocus_sigma_px);
}

/// A moving image is the mean of images this far apart: a lens of 0.7 px sigma leaves
/// 2·exp(−2π²·0.7²) = 0.01 % of the ripple between them.
constexpr double kSubExposureStep_px = 1.0;

/// Sub-exposures that a motion needs, by the rig's turn and its shift before a wall at 1 m.
int needed_sub_exposures(const RenderSettings& settings, const CameraModel& camera,
                         const CameraMotion& motion) {
  if (settings.exposure_s <= 0) return 1;
  const Rigid3 first = motion(-0.5 * settings.exposure_s);
  const Rigid3 last = motion(0.5 * settings.exposure_s);
  const double turn_rad = angle_between_rad(first.rotation, last.rotation);
  const double shift_m = (last.translation - first.translation).norm();
  const double blur_px = (turn_rad + shift_m / 1.0) * camera.parameters().fu_px;
  return std::clamp(static_cast<int>(std::ceil(blur_px / kSubExposureStep_px)), 1,
                    settings.sub_exposures);
}

Rigid3 world_from_plane(const Surface& surface) {
  Eigen::Matrix3d axes;
  axes << surface.right, surface.up, surface.normal();
  return {Eigen::Quaterniond(axes).normalized(), surface.origin};
}

Renderer::Stage make_stage(const Scene& scene, const RenderSettings& settings) {
  Renderer::Stage stage{&scene,
                        settings,
                        WallTexture(scene.seed, settings.texture_contrast),
                        Illumination(scene, settings.uniform_light),
                        {},
                        {},
                        {}};
  for (const PlacedMarker& marker : scene.markers) {
    stage.prints.emplace_back(marker.id, static_cast<float>(settings.black_albedo),
                              static_cast<float>(settings.white_albedo));
  }
  Random random = Random::of({scene.seed, 4});
  for (const Surface& surface : scene.surfaces) {
    stage.albedo_by_surface.push_back(static_cast<float>(random.uniform(0.28, 0.62)));
    stage.world_from_surface.push_back(world_from_plane(surface));
  }
  return stage;
}

}  // namespace

Renderer::Renderer(const Scene& scene, const Rig& rig, const RenderSettings& settings, int threads)
    : stage_(make_stage(scene, settings)),
      plain_(blur_sigma_px(settings), 1),
      fine_(blur_sigma_px(settings), settings.oversampling),
      sensor_(settings) {
  const int padding_px = PointSpread::radius_px(blur_sigma_px(settings)) + SurfacePatch::kReach_px;
  std::vector<std::optional<RayTable>> tables(rig.cameras.size());
  parallel_for(rig.cameras.size(), threads,
               [&](std::size_t i) { tables[i].emplace(rig.cameras[i].model, padding_px); });
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    models_.push_back(rig.cameras[i].model);
    rays_.push_back(std::move(*tables[i]));
  }
}

GrayImage Renderer::render(std::size_t camera, const CameraMotion& motion,
                           std::uint64_t noise_seed) const {
  return sensor_.expose(irradiance(camera, motion), noise_seed);
}

IrradianceImage Renderer::irradiance(std::size_t camera, const CameraMotion& motion) const {
  const RayTable& rays = rays_[camera];
  const RenderSettings& settings = stage_.settings;
  const int radius_px = PointSpread::radius_px(blur_sigma_px(settings));
  IrradianceImage image{rays.width_px(), rays.height_px(), {}};
  image.values.resize(static_cast<std::size_t>(image.width_px) *
                      static_cast<std::size_t>(image.height_px));
  TilePainter painter(stage_, rays, radius_px);
  const bool moves = settings.exposure_s > 0 || settings.readout_s > 0;
  const int sub_exposures = needed_sub_exposures(settings, models_[camera], motion);
  const double middle_row = 0.5 * (image.height_px - 1);
  std::vector<CameraView> views;
  for (int y0 = 0; y0 < image.height_px; y0 += kTile_px) {
    const int height = std::min(kTile_px, image.height_px - y0);
    const double first_px = y0 - radius_px;
    const double last_px = y0 + height + radius_px;
    if (views.empty() || moves) {
      views.clear();
      for (int k = 0; k < sub_exposures; ++k) {
        const double within_s = settings.exposure_s * ((k + 0.5) / sub_exposures - 0.5);
        const auto pose_at_row = [&](double row_px) {
          return motion(within_s + settings.readout_s * (row_px - middle_row) / image.height_px);
        };
        views.push_back(
            view_of(stage_, models_[camera], pose_at_row(first_px), pose_at_row(last_px)));
      }
    }
    for (int x0 = 0; x0 < image.width_px; x0 += kTile_px) {
      const Tile tile{x0, y0, std::min(kTile_px, image.width_px - x0), height};
      const bool plain = painter.is_plain(tile, views);
      painter.paint(tile, views, first_px, last_px, plain ? plain_ : fine_, image);
    }
  }
  return image;
}

}  // namespace waymark::simulator
