#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>

#include "core/base/error.h"
#include "simulator/render_settings.h"
#include "simulator/rig_library.h"
#include "simulator/scene.h"

namespace waymark::simulator {

/// What to render and how.
struct RenderJob {
  int positions = 0;       ///< along the scene's way; 0: as many as the scene says
  std::uint64_t seed = 1;  ///< of noise and skew
  int threads = 0;         ///< 0: all processors; changes nothing in the images
  RenderSettings settings;
  bool show_progress = true;
};

/// How many images were made, and how long it took without preparation.
struct RenderResult {
  std::size_t images = 0;
  double seconds = 0;
};

/// Renders a capture folder with ground truth. Stops at `stop` (Ctrl-C) with nothing left behind.
/// Errors: cant_create (the folder exists), io (disk full), permission.
[[nodiscard]] Expected<RenderResult> render_capture(const Scene& scene, const SimulatedRig& rig,
                                                    const RenderJob& job,
                                                    const std::filesystem::path& folder,
                                                    const std::atomic<bool>& stop);

}  // namespace waymark::simulator
