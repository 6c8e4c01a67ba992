#include "simulator/illumination.h"

#include <algorithm>
#include <cmath>

#include "simulator/random.h"

namespace waymark::simulator {
namespace {

/// Size of the patches that shadows are made of, and how wide their edges are.
constexpr double kShadowPatch_m = 1.3;
constexpr double kPenumbra = 0.18;

/// A lamp has a size: no light is infinite.
constexpr double kLampSize2_m2 = 0.05;

/// Share of a lamp's light that the room scatters, so that a face turned away is not black.
constexpr double kScatteredShare = 0.15;

/// Spacing of the nodes of the light maps.
constexpr double kNodeStep_m = 0.08;

double lattice_value(std::uint64_t seed, int surface, int x, int y) {
  return Random::of({seed, 3, static_cast<std::uint64_t>(surface),
                     static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)),
                     static_cast<std::uint64_t>(static_cast<std::uint32_t>(y))})
      .uniform();
}

double smooth_step(double t) {
  const double s = std::clamp(t, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

/// Shadow's depth, 0…1, of things that are not modelled: blotches with soft edges.
double shadow(const Scene& scene, int surface, double across_m, double above_m) {
  const double x = across_m / kShadowPatch_m;
  const double y = above_m / kShadowPatch_m;
  const double fx = smooth_step(x - std::floor(x));
  const double fy = smooth_step(y - std::floor(y));
  const int ix = static_cast<int>(std::floor(x));
  const int iy = static_cast<int>(std::floor(y));
  const auto value = [&](int dx, int dy) {
    return lattice_value(scene.seed, surface, ix + dx, iy + dy);
  };
  const double smooth = std::lerp(std::lerp(value(0, 0), value(1, 0), fx),
                                  std::lerp(value(0, 1), value(1, 1), fx), fy);
  return smooth_step((smooth - 0.5) / kPenumbra + 0.5);
}

double unscaled_irradiance(const Scene& scene, int surface, double across_m, double above_m) {
  const Surface& face = scene.surfaces[static_cast<std::size_t>(surface)];
  const Eigen::Vector3d point = face.point(across_m, above_m);
  const Eigen::Vector3d normal = face.normal();
  double lamps = 0;
  for (const Lamp& lamp : scene.lighting.lamps) {
    const Eigen::Vector3d to_lamp = lamp.position_m - point;
    const double distance2 = to_lamp.squaredNorm() + kLampSize2_m2;
    const double cosine = normal.dot(to_lamp) / std::sqrt(distance2);
    lamps += lamp.strength * (0.5 * std::max(0.0, cosine) + kScatteredShare) / distance2;
  }
  const double lit = 1.0 - scene.lighting.shadow_depth * shadow(scene, surface, across_m, above_m);
  return scene.lighting.ambient + lamps * lit;
}

/// The factor that brings the markers' mean irradiance to 1, as a camera's exposure control would.
double exposure(const Scene& scene) {
  double sum = 0;
  for (const PlacedMarker& marker : scene.markers) {
    const Surface& face = scene.surfaces[static_cast<std::size_t>(marker.surface)];
    const Eigen::Vector3d on_face = marker.world_from_marker.translation - face.origin;
    sum +=
        unscaled_irradiance(scene, marker.surface, on_face.dot(face.right), on_face.dot(face.up));
  }
  return sum > 0 ? static_cast<double>(scene.markers.size()) / sum : 1.0;
}

}  // namespace

Illumination::Illumination(const Scene& scene, bool uniform) {
  if (uniform) return;
  const double scale = exposure(scene);
  for (std::size_t surface = 0; surface < scene.surfaces.size(); ++surface) {
    const Surface& face = scene.surfaces[surface];
    LightMap map;
    map.columns = static_cast<std::size_t>(std::ceil(face.width_m / kNodeStep_m)) + 1;
    map.rows = static_cast<std::size_t>(std::ceil(face.height_m / kNodeStep_m)) + 1;
    map.irradiance.reserve(map.columns * map.rows);
    for (std::size_t row = 0; row < map.rows; ++row) {
      for (std::size_t column = 0; column < map.columns; ++column) {
        map.irradiance.push_back(static_cast<float>(
            scale * unscaled_irradiance(scene, static_cast<int>(surface),
                                        static_cast<double>(column) * kNodeStep_m,
                                        static_cast<double>(row) * kNodeStep_m)));
      }
    }
    maps_.push_back(std::move(map));
  }
}

float Illumination::at(int surface, float across_m, float above_m) const {
  if (maps_.empty()) return 1.0F;
  const LightMap& map = maps_[static_cast<std::size_t>(surface)];
  constexpr auto kPerStep = static_cast<float>(1.0 / kNodeStep_m);
  const float x =
      std::clamp(across_m * kPerStep, 0.0F, static_cast<float>(map.columns - 1) - 1e-3F);
  const float y = std::clamp(above_m * kPerStep, 0.0F, static_cast<float>(map.rows - 1) - 1e-3F);
  const auto column = static_cast<std::size_t>(x);
  const auto row = static_cast<std::size_t>(y);
  const float* lower = map.irradiance.data() + row * map.columns + column;
  const float* upper = lower + map.columns;
  const float right = x - static_cast<float>(column);
  return std::lerp(std::lerp(lower[0], lower[1], right), std::lerp(upper[0], upper[1], right),
                   y - static_cast<float>(row));
}

}  // namespace waymark::simulator
