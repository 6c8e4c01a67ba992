#pragma once

#include <CLI/CLI.hpp>
#include <atomic>
#include <optional>
#include <string>

#include "simulator/render_capture.h"
#include "simulator/simulate_detections.h"

namespace waymark::simulator {

/// The command line of `simulator render`.
struct RenderOptions {
  std::string scene, rig, output;
  std::string level = "still";
  std::string response = "linear";
  std::string format = "jpg";
  std::optional<double> speed_mps;  ///< in place of the scene's
  RenderJob job;
  /// Deviations from the level, where given.
  std::optional<double> psf_sigma_px, defocus_sigma_px, exposure_ms, readout_ms, vignetting,
      texture_contrast, white_level;
  bool no_noise = false;
};

/// The command line of `simulator detections`.
struct DetectionsOptions {
  std::string scene, rig, output;
  std::optional<double> speed_mps;  ///< in place of the scene's
  DetectionsJob job;
  double stamp_skew_ms = 0;
};

void add_render_command(CLI::App& app, RenderOptions& options);
void add_detections_command(CLI::App& app, DetectionsOptions& options);

/// Each returns the program's exit code; results on stdout, errors as one line on stderr.
int run_list();
int run_render(const RenderOptions& options, const std::atomic<bool>& stop);
int run_detections(const DetectionsOptions& options, const std::atomic<bool>& stop);

}  // namespace waymark::simulator
