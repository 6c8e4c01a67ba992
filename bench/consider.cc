/// Do a map's sigmas hold where calibrations are off by what they are stated to be sure of?
/// Simulated detections, every seed with a calibration of its own drawn from the default sigmas:
/// errors of markers against metric covariances. Prints Markdown.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/drawn_calibration.h"
#include "bench/map_nees.h"
#include "bench/scene_trial.h"

namespace waymark::bench {
namespace {

struct Options {
  std::string work;
  std::vector<std::string> scenes = {"room1", "room2"};
  std::vector<std::string> rigs = {"cg120", "mono"};
  int seeds = 100;
  int positions = 0;
  double noise_px = 0.1;
};

/// One scene and rig.
struct Row {
  std::vector<double> markers, joint;
  double within = 0, error_m = 0, sigma_m = 0, noise_share = 0, dropped_worst = 0;
};

Status add_seed(const Options& options, const std::string& scene, const std::string& rig, int seed,
                Row& row) {
  auto capture =
      simulated_detections(options.work, scene, rig, options.noise_px, seed, options.positions);
  if (!capture) return tl::make_unexpected(capture.error());
  capture->detected =
      with_drawn_calibration(std::move(capture->detected), static_cast<std::uint64_t>(seed));
  const auto trial = map_scene(*capture, {});
  if (!trial) return tl::make_unexpected(trial.error());
  const BuiltSubMap& first = trial->built.submaps.front();
  const MapNees nees = map_nees(first.map, *capture->truth.world_from_marker);
  const double share = 1.0 / options.seeds;
  row.markers.push_back(nees.markers);
  row.joint.push_back(nees.joint);
  row.within += share * nees.within;
  row.error_m += share * nees.error_m * nees.error_m;
  row.sigma_m += share * nees.sigma_m * nees.sigma_m;
  row.noise_share += share * first.noise_share;
  row.dropped_worst = std::max(row.dropped_worst, first.dropped_worst);
  fmt::print(stderr, "{} {} seed {}: NEES {:.3f}, joint {:.3f}, {:.2f} mm at {:.2f} mm\n", scene,
             rig, seed, nees.markers, nees.joint, 1e3 * nees.error_m, 1e3 * nees.sigma_m);
  return {};
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

Status run(const Options& options) {
  fmt::print(
      "{} calibrations each, drawn from Kalibr's sigmas; {} px Gaussian per axis.\n\n| scene, rig "
      "| "
      "NEES/dof, markers: mean (largest) | joint: mean | by within-map sigmas | RMS error / "
      "stated, "
      "mm | noise share | worst marker's dropped |\n|---|---|---|---|---|---|---|\n",
      options.seeds, options.noise_px);
  for (const std::string& scene : options.scenes) {
    for (const std::string& rig : options.rigs) {
      Row row;
      for (int seed = 1; seed <= options.seeds; ++seed) {
        if (auto added = add_seed(options, scene, rig, seed, row); !added) return added;
      }
      fmt::print(
          "| {} {} | {:.3f} ({:.2f}) | {:.3f} | {:.2f} | {:.2f} / {:.2f} | {:.3f} | {:.2f} % |\n",
          scene, rig, mean_of(row.markers),
          *std::max_element(row.markers.begin(), row.markers.end()), mean_of(row.joint), row.within,
          1e3 * std::sqrt(row.error_m), 1e3 * std::sqrt(row.sigma_m), row.noise_share,
          100 * row.dropped_worst);
      std::fflush(stdout);
    }
  }
  return {};
}

}  // namespace
}  // namespace waymark::bench

int main(int argc, char** argv) {
  CLI::App app("Sigmas of maps whose calibrations are off by what they are stated to be sure of");
  waymark::bench::Options options;
  app.add_option("work", options.work, "Folder for captures; they are removed again")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--scenes", options.scenes)->delimiter(',');
  app.add_option("--rigs", options.rigs)->delimiter(',');
  app.add_option("--seeds", options.seeds)->check(CLI::Range(1, 10000));
  app.add_option("--positions", options.positions)->check(CLI::Range(0, 100000));
  app.add_option("--noise-px", options.noise_px)->check(CLI::Range(0.001, 5.0));
  CLI11_PARSE(app, argc, argv);
  const auto status = waymark::bench::run(options);
  if (status) return 0;
  fmt::print(stderr, "bench_consider: {}\n", status.error().message);
  return status.error().exit_code();
}
