#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/camera/rig.h"
#include "core/capture/detection.h"
#include "simulator/random.h"
#include "simulator/scene.h"
#include "simulator/trajectory.h"

namespace waymark::bench {

/// How the cameras of a world stand to each other.
enum class RigKind { cg60, cg120, mono, fisheye };

[[nodiscard]] const char* name_of(RigKind kind);

/// A building, a rig on its way through it, and what is stated of both. Drawn sound: what is stated
/// is true. Faults change the one or the other.
struct World {
  std::string name;  ///< "room1 cg60 driving"
  RigKind kind = RigKind::cg60;
  simulator::Scene scene;  ///< markers as they hang, with their true sizes
  Rig rig;                 ///< as mounted
  Rig stated_rig;          ///< as in rig.yaml
  MarkerCatalog stated_catalog;
  std::shared_ptr<const simulator::Trajectory> way;  ///< the scene's
  bool driving = false;  ///< at even speed while images are taken; else it stands for each set
  double start_m = 0;    ///< of the section along the scene's way
  double speed_mps = 0;
  double period_s = 0;  ///< between frame sets
  std::size_t sets = 0;
  double noise_px = 0.1;         ///< standard deviation of corners, per axis
  bool with_covariances = true;  ///< as our detector states them
  std::uint64_t seed = 0;        ///< of the noise

  /// When cameras truly expose (s after the first set) and what they stamp, by set and camera.
  std::vector<std::vector<double>> exposed_s;
  std::vector<std::vector<Stamp>> stamps;

  /// A camera that stands elsewhere on the rig from a set on.
  struct Bump {
    std::size_t camera = 0;
    std::size_t from_set = 0;
    Rigid3 rig_from_cam;
  };
  std::vector<Bump> bumps;
  /// world_from_marker by set of markers (index in the scene) that do not stay where they are.
  std::map<std::size_t, std::vector<Rigid3>> wandering;
  /// Width over height of markers (index in the scene) that are not square.
  std::map<std::size_t, double> wider;

  [[nodiscard]] Rigid3 world_from_rig(double time_s) const;
  [[nodiscard]] Rigid3 world_from_rig_at_set(std::size_t set) const;
  [[nodiscard]] std::size_t cameras() const { return rig.cameras.size(); }
};

/// A section of one of the simulator's six scenes, seen by a rig of that kind whose lenses and
/// mounts scatter as built ones do (± 4 % in focal length, ± 15 px, ± 3°, ± 2 cm), with 0.1–0.3 px
/// of noise.
[[nodiscard]] World draw_world(RigKind kind, int scene, bool driving, simulator::Random& random);

/// What the cameras see, by rising (set, camera), stamped as they stamp.
[[nodiscard]] std::vector<ImageDetections> seen_images(const World& world);

/// Whether each camera sees two markers in half of its images, as somebody who maps a building
/// would see to.
[[nodiscard]] bool is_well_seen(const World& world);

/// In how many images each marker (index in the scene) is seen.
[[nodiscard]] std::vector<int> sights_of(const World& world,
                                         const std::vector<ImageDetections>& images);

}  // namespace waymark::bench
