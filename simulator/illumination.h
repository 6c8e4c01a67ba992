#pragma once

#include <cstddef>
#include <vector>

#include "simulator/scene.h"

namespace waymark::simulator {

/// Light that falls on a surface: ambient, lamps by distance and angle, and soft shadows of things
/// that are not modelled (people, pipes, furniture), fixed to the surface.
class Illumination {
 public:
  /// Computes a map of the light for every surface of the scene. `uniform`: irradiance 1
  /// everywhere.
  Illumination(const Scene& scene, bool uniform);

  /// Irradiance relative to the level at which white paper is well exposed, at plane coordinates
  /// (m) of a surface; beyond its edges, that at the edge.
  [[nodiscard]] float at(int surface, float across_m, float above_m) const;

 private:
  /// Irradiance at nodes of a grid over one surface, row by row from its lower edge.
  struct LightMap {
    std::size_t columns = 0;
    std::size_t rows = 0;
    std::vector<float> irradiance;
  };

  std::vector<LightMap> maps_;  ///< by surface; none when the light is uniform
};

}  // namespace waymark::simulator
