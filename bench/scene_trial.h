#pragma once

#include <filesystem>
#include <string>

#include "core/base/error.h"
#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/evaluate/evaluation.h"
#include "mapbuilder/evaluate/ground_truth.h"

namespace waymark::bench {

/// Wall clock and CPU of a stage (s).
struct StageTime {
  double wall_s = 0;
  double cpu_s = 0;
};

/// A simulated capture, rendered and searched, with its truth.
struct SceneCapture {
  std::string scene, rig;
  DetectedCapture detected;
  GroundTruth truth;
  bool mono = false;  ///< every image is a frame of its own
  std::size_t images = 0;
  StageTime detection;  ///< all images: read, decoded, searched
};

/// The folder of a scene's capture below `captures`: rendered now unless it is there. `rig` mono
/// takes cg120's images. `positions` 0: all of the scene's.
[[nodiscard]] Expected<std::filesystem::path> rendered_capture(
    const std::filesystem::path& captures, const std::string& scene, const std::string& rig,
    const std::string& level, int positions);

/// Opens a simulated capture folder, searches its images (or takes its detections.csv) and reads
/// its truth.
[[nodiscard]] Expected<SceneCapture> take_capture(const std::filesystem::path& folder,
                                                  const std::string& scene, const std::string& rig);

/// A scene's detections, with Gaussian noise and nothing else wrong. Takes a folder's place below
/// `work` for a moment. `positions` 0: all of the scene's.
[[nodiscard]] Expected<SceneCapture> simulated_detections(const std::filesystem::path& work,
                                                          const std::string& scene,
                                                          const std::string& rig, double noise_px,
                                                          int seed, int positions);

/// A map beside its truth.
struct SceneTrial {
  Observations observations;
  BuildResult built;
  StageTime mapping;  ///< detections to map
  std::size_t true_markers = 0;
  std::size_t frame_sets = 0;  ///< that hold an observation
  MarkerEvaluation markers;    ///< of the first sub-map, as is all else
  CameraEvaluation cameras;    ///< of rigs, or of each image's camera for mono
};

/// Builds the map and evaluates its first sub-map.
[[nodiscard]] Expected<SceneTrial> map_scene(const SceneCapture& capture,
                                             const BuildOptions& options);

}  // namespace waymark::bench
