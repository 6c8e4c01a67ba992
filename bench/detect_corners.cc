// Errors of refined corners on rendered markers, whose true corners are known: one row per size,
// tilt and point spread. Usage: bench_detect_corners [trials per row, default 200]

#include <fmt/core.h>

#include <cstdlib>

#include "tests/support/corner_trials.h"

namespace {

using waymark::Distortion;
using waymark::testing::CornerErrors;
using waymark::testing::CornerTrials;

struct Row {
  double min_side_px, max_side_px;
  double min_tilt_deg, max_tilt_deg;
};

void print(const std::string& what, const CornerErrors& errors, int count) {
  fmt::print("| {:<34} | {:4}/{:<4} | {:.4f} | {:.3f} | {:+.4f} | {:5.2f} | {:4.0f} |", what,
             errors.refined, count, errors.rms_px, errors.max_px, errors.edge_bias_px,
             errors.normalized_squares / 2, errors.mean_us);
  for (const auto& [reason, times] : errors.failures) fmt::print(" {}: {}", reason, times);
  fmt::print("\n");
}

void run(const std::string& what, const CornerTrials& trials,
         Distortion distortion = Distortion::none) {
  print(what, run_corner_trials(waymark::testing::trial_camera(distortion), trials), trials.count);
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 200;  // NOLINT(cert-err34-c)
  fmt::print(
      "Rough corners ±1 px, noise 2 grey levels, 40…210, paper one cell wide, five families.\n"
      "| side px, tilt, PSF σ               | refined   | RMS px | max   | bias    | NEES  | µs   "
      "|\n"
      "|---|---|---|---|---|---|---|\n");
  constexpr Row kRows[]{{20, 30, 0, 60},   {30, 45, 0, 0},    {30, 45, 0, 60},  {30, 45, 60, 60},
                        {45, 70, 0, 0},    {45, 70, 0, 60},   {45, 70, 60, 60}, {70, 140, 0, 60},
                        {45, 100, 70, 80}, {100, 140, 70, 80}};
  for (const Row& row : kRows) {
    for (const double psf_sigma_px : {0.6, 0.8, 1.0}) {
      CornerTrials trials;
      trials.count = count;
      trials.min_side_px = row.min_side_px;
      trials.max_side_px = row.max_side_px;
      trials.min_tilt_deg = row.min_tilt_deg;
      trials.max_tilt_deg = row.max_tilt_deg;
      trials.image.psf_sigma_px = psf_sigma_px;
      run(fmt::format("{}–{}, {}–{}°, {}", row.min_side_px, row.max_side_px, row.min_tilt_deg,
                      row.max_tilt_deg, psf_sigma_px),
          trials);
    }
  }
  CornerTrials trials;
  trials.count = count;
  run("45–140, 0–60°, 0.8, radtan", trials, Distortion::radtan);
  run("45–140, 0–60°, 0.8, equidistant", trials, Distortion::equidistant);
  CornerTrials uneven = trials;
  uneven.image.gradient_grey = 150;
  run("…, light from 0.7 to 1.3", uneven);
  CornerTrials srgb = trials;
  srgb.image.srgb = true;
  run("…, sRGB response", srgb);
  CornerTrials saturated = trials;
  saturated.white = 330;
  run("…, paper saturated (330 of 255)", saturated);
  CornerTrials noisy = trials;
  noisy.image.noise_grey = 8;
  run("…, noise 8 grey levels", noisy);
}
