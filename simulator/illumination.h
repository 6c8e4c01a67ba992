#pragma once

#include "simulator/scene.h"

namespace waymark::simulator {

/// Light that falls on a surface: ambient, lamps by distance and angle, and soft shadows of things
/// that are not modelled (people, pipes, furniture), fixed to the surface.
class Illumination {
 public:
  /// The scene must outlive it. `uniform`: irradiance 1 everywhere.
  Illumination(const Scene& scene, bool uniform);

  /// Irradiance relative to the level at which white paper is well exposed, at plane coordinates
  /// (m) of a surface.
  [[nodiscard]] float at(int surface, double across_m, double above_m) const;

 private:
  [[nodiscard]] double unscaled(int surface, double across_m, double above_m) const;
  [[nodiscard]] double shadow(int surface, double across_m, double above_m) const;

  const Scene& scene_;
  bool uniform_;
  double exposure_ = 1.0;  ///< that brings the markers' mean irradiance to 1
};

}  // namespace waymark::simulator
