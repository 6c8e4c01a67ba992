// Edge bias of simulated cameras, whose true one is known: a row per camera, then how far off in
// stated sigmas. Usage: bench_edge_bias [markers per camera, default 40]

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/support/edge_trials.h"

namespace {

using waymark::testing::EdgeTrials;

}  // namespace

int main(int argc, char** argv) {
  const int markers = argc > 1 ? std::atoi(argv[1]) : 40;  // NOLINT(cert-err34-c)
  fmt::print(
      "| response | blur σ px | noise | inset true | measured | ± | off, σ | told | left | ms |\n");
  double squares = 0;
  double worst = 0;
  int cameras = 0;
  for (const bool srgb : {false, true}) {
    for (const double psf : {0.1, 0.3, 0.5, 0.7, 1.0, 1.5}) {
      for (const double noise : {0.5, 1.5, 4.0}) {
        for (const double varies : {0.0, 0.4}) {
          EdgeTrials trials;
          trials.images = markers;
          trials.blur_varies = varies;
          trials.image.srgb = srgb;
          trials.image.psf_sigma_px = psf;
          trials.image.noise_grey = noise;
          trials.image.seed = 1 + static_cast<std::uint64_t>(cameras);
          const auto edges = measure_edges(waymark::testing::trial_camera(), trials);
          ++cameras;
          if (!edges.measured) {
            fmt::print("| {} | {} | {} | can't tell |\n", srgb ? "sRGB" : "linear", psf, noise);
            continue;
          }
          const double off =
              (edges.measured->inset_px - edges.true_inset_px) / edges.measured->sigma_px;
          squares += off * off;
          worst = std::max(worst, std::abs(off));
          fmt::print(
              "| {} | {:.1f} ± {:.0f} % | {:.1f} | {:+.4f} | {:+.4f} | {:.4f} | {:+.2f} | {} | "
              "{:+.4f} | {:.1f} |\n",
              srgb ? "sRGB" : "linear", psf, 100 * varies, noise, edges.true_inset_px,
              edges.measured->inset_px, edges.measured->sigma_px, off,
              edges.measured->response ? to_string(*edges.measured->response) : "open",
              edges.corrected_px, edges.mean_fit_ms);
        }
      }
    }
  }
  fmt::print("{} cameras: off by {:.2f} sigmas RMS, {:.2f} at most\n", cameras,
             std::sqrt(squares / std::max(1, cameras)), worst);
}
