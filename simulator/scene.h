#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/marker/marker_catalog.h"
#include "simulator/surface.h"
#include "simulator/trajectory.h"

namespace waymark::simulator {

/// Axis-aligned solid box: a shelf, a pillar, the core of a corridor's ring.
struct Box {
  std::string name;
  Eigen::Vector3d min_m;
  Eigen::Vector3d max_m;
};

/// A marker glued to a surface.
struct PlacedMarker {
  MarkerId id;
  double size_m = 0;  ///< outer edge of the black border
  Rigid3 world_from_marker;
  int surface = 0;  ///< index into Scene::surfaces
};

/// A point-like lamp; its light falls off with the square of the distance and with the cosine at
/// the surface.
struct Lamp {
  Eigen::Vector3d position_m;
  double strength = 1.0;  ///< irradiance at 1 m, relative to ambient = 1
};

/// How a scene is lit. Irradiance 1 is the level at which white paper is well exposed.
struct Lighting {
  double ambient = 0.45;
  std::vector<Lamp> lamps;
  double shadow_depth = 0.5;  ///< share of the light that the deepest cast shadow takes, 0…1
};

/// A building with its markers and the way a rig takes through it. World frame: z up, the origin in
/// one corner of the floor, m.
struct Scene {
  std::string name;
  std::string title;
  std::uint64_t seed = 1;  ///< of the placement's jitter and of the walls' texture
  Eigen::Vector3d room_size_m;
  std::vector<Surface> surfaces;  ///< the room's six first; every face that can be seen
  std::vector<Box> boxes;
  std::vector<Surface>
      walls;  ///< one face of each free-standing wall, for occlusion from both sides
  MarkerCatalog catalog;
  std::vector<PlacedMarker> markers;  ///< by rising id
  Lighting lighting;
  TrajectoryPlan trajectory;
};

}  // namespace waymark::simulator
