#include "simulator/illumination.h"

#include <algorithm>
#include <cmath>

#include "simulator/random.h"

namespace waymark::simulator {
namespace {

/// Size of the patches that shadows are made of, and how wide their edges are.
constexpr double kShadowPatch_m = 1.3;
constexpr double kPenumbra = 0.18;

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

}  // namespace

Illumination::Illumination(const Scene& scene, bool uniform) : scene_(scene), uniform_(uniform) {
  double sum = 0;
  for (const PlacedMarker& marker : scene.markers) {
    const Surface& face = scene.surfaces[static_cast<std::size_t>(marker.surface)];
    const Eigen::Vector3d on_face = marker.world_from_marker.translation - face.origin;
    sum += unscaled(marker.surface, on_face.dot(face.right), on_face.dot(face.up));
  }
  if (sum > 0) exposure_ = static_cast<double>(scene.markers.size()) / sum;
}

float Illumination::at(int surface, double across_m, double above_m) const {
  return uniform_ ? 1.0F : static_cast<float>(exposure_ * unscaled(surface, across_m, above_m));
}

double Illumination::unscaled(int surface, double across_m, double above_m) const {
  const Surface& face = scene_.surfaces[static_cast<std::size_t>(surface)];
  const Eigen::Vector3d point =
      face.point(std::clamp(across_m, 0.0, face.width_m), std::clamp(above_m, 0.0, face.height_m));
  const Eigen::Vector3d normal = face.normal();
  double lamps = 0;
  for (const Lamp& lamp : scene_.lighting.lamps) {
    const Eigen::Vector3d to_lamp = lamp.position_m - point;
    const double distance2 =
        to_lamp.squaredNorm() + 0.05;  // a lamp has a size: no light is infinite
    const double cosine = normal.dot(to_lamp) / std::sqrt(distance2);
    // Half of the light is scattered by the room, so that a face turned away is not black.
    lamps += lamp.strength * (0.5 * std::max(0.0, cosine) + 0.15) / distance2;
  }
  const double direct =
      lamps * (1.0 - scene_.lighting.shadow_depth * shadow(surface, across_m, above_m));
  return scene_.lighting.ambient + direct;
}

double Illumination::shadow(int surface, double across_m, double above_m) const {
  const double x = across_m / kShadowPatch_m;
  const double y = above_m / kShadowPatch_m;
  const double fx = smooth_step(x - std::floor(x));
  const double fy = smooth_step(y - std::floor(y));
  const int ix = static_cast<int>(std::floor(x));
  const int iy = static_cast<int>(std::floor(y));
  const auto value = [&](int dx, int dy) {
    return lattice_value(scene_.seed, surface, ix + dx, iy + dy);
  };
  const double smooth = std::lerp(std::lerp(value(0, 0), value(1, 0), fx),
                                  std::lerp(value(0, 1), value(1, 1), fx), fy);
  return smooth_step((smooth - 0.5) / kPenumbra + 0.5);
}

}  // namespace waymark::simulator
