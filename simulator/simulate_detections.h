#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>

#include "core/base/error.h"
#include "simulator/rig_library.h"
#include "simulator/scene.h"

namespace waymark::simulator {

/// What a detector would find, and what is wrong with it. Everything is drawn from `seed`.
struct DetectionsJob {
  int positions = 0;  ///< along the scene's way; 0: as many as the scene says
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: all processors; changes nothing in the result
  double noise_px =
      0.1;               ///< standard deviation per axis of every corner; written as its covariance
  double miss_rate = 0;  ///< share of visible markers that are not found, 0…1
  double false_rate = 0;     ///< share of detections whose id is another one, drawn from the whole
                             ///< catalog's scene, 0…1
  double drop_out_rate = 0;  ///< share of images that are lost, 0…1
  double stamp_skew_sigma_s = 0;  ///< see CapturePlan; above 0 the rig moves while it takes images
  int twins = 0;      ///< markers that hang a second time elsewhere, in place of another one
  int moved = 0;      ///< markers that change their place half-way
  int mis_sized = 0;  ///< markers whose stated size is wrong
  bool show_progress = true;
};

/// What was written.
struct DetectionsResult {
  std::size_t images = 0;
  std::size_t detections = 0;
};

/// Writes a capture folder with detections.csv and ground truth, without images; what was corrupted
/// stands in groundtruth/corruptions.json. Errors: cant_create (the folder exists), io (disk full),
/// permission, usage (more corrupted markers than the scene has).
[[nodiscard]] Expected<DetectionsResult> simulate_detections(const Scene& scene,
                                                             const SimulatedRig& rig,
                                                             const DetectionsJob& job,
                                                             const std::filesystem::path& folder,
                                                             const std::atomic<bool>& stop);

}  // namespace waymark::simulator
