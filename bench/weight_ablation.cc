/// Table IV of the paper: what the observation weight does, and eq. 10's seed, beside the inverse
/// corner covariance and seeds scored on all observations. Prints Markdown.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "bench/paper_figures.h"
#include "bench/scene_trial.h"

namespace waymark::bench {
namespace {

struct Options {
  std::string captures;
  std::vector<std::string> scenes = {"room1", "warehouse", "calibration"};
  std::string rig = "cg120";
  double noise_px = 0;  ///< 0: the rendered images; else simulated detections
  int positions = 0;
};

/// One line of the ablation.
struct Variant {
  std::string name;
  Weighting weighting;
  double lambda_distance, lambda_angle, lambda_ambiguity;
};

const std::vector<Variant>& variants() {
  static const std::vector<Variant> all = {
      {"L", Weighting::paper, 0, 0, 0},
      {"L_d", Weighting::paper, 1, 0, 0},
      {"L_d/theta", Weighting::paper, 1, 5, 0},
      {"L_all", Weighting::paper, 1, 5, 0.1},
      {"covariance", Weighting::covariance, 0, 0, 0},
  };
  return all;
}

BuildOptions options_of(const Variant& variant, RigPoseSeed seed) {
  BuildOptions options;
  options.noise.weighting = variant.weighting;
  options.noise.paper.lambda_distance = variant.lambda_distance;
  options.noise.paper.lambda_angle = variant.lambda_angle;
  options.noise.paper.lambda_ambiguity = variant.lambda_ambiguity;
  options.growth.rig_pose.seed = seed;
  return options;
}

std::string text(const std::optional<PoseAccuracy>& accuracy) {
  if (!accuracy) return "-";
  return fmt::format("{:.3f} / {:.4f}", 1e3 * accuracy->rmse.translation_m,
                     accuracy->rmse.rotation_rad * 180 / M_PI);
}

std::string papers(const std::string& scene, const std::string& weight) {
  for (const PaperWeightRow& row : kPaperWeightRows) {
    if (row.scene != scene || row.weight != weight) continue;
    return fmt::format("{:.0f} / {:.3f} | {:.0f} / {:.3f}", 1e3 * row.marker_m, row.marker_deg,
                       1e3 * row.camera_m, row.camera_deg);
  }
  return "- | -";
}

Status run_scene(const Options& options, const std::string& scene) {
  auto capture = options.noise_px > 0 ? simulated_detections(options.captures, scene, options.rig,
                                                             options.noise_px, 1, options.positions)
                                      : [&]() -> Expected<SceneCapture> {
    const auto folder =
        rendered_capture(options.captures, scene, options.rig, "still", options.positions);
    if (!folder) return tl::make_unexpected(folder.error());
    return take_capture(*folder, scene, options.rig);
  }();
  if (!capture) return tl::make_unexpected(capture.error());
  for (const RigPoseSeed seed : {RigPoseSeed::scored_solutions, RigPoseSeed::best_own_fit}) {
    for (const Variant& variant : variants()) {
      const auto trial = map_scene(*capture, options_of(variant, seed));
      if (!trial) {
        fmt::print("| {} | {} | {} | no map: {} |\n", scene, variant.name,
                   seed == RigPoseSeed::best_own_fit ? "eq. 10" : "scored", trial.error().message);
        continue;
      }
      const BuiltSubMap& first = trial->built.submaps.front();
      fmt::print("| {} | {} | {} | {} | {}/{} in {} | {} | {} | {} | {}/{} | {} | {:.1f} |\n",
                 scene, variant.name, seed == RigPoseSeed::best_own_fit ? "eq. 10" : "scored",
                 papers(scene, variant.name), trial->markers.found.size(), trial->true_markers,
                 trial->built.submaps.size(), text(trial->markers.errors),
                 text(trial->cameras.errors), first.rejected, trial->cameras.found,
                 trial->frame_sets, first.converged ? "yes" : "no", trial->mapping.wall_s);
      std::fflush(stdout);
    }
  }
  return {};
}

Status run(const Options& options) {
  fmt::print(
      "| scene | weight | seed | paper: markers, mm / deg | paper: cameras | markers in "
      "sub-maps | markers, mm / deg | cameras, mm / deg | rejected | poses | settled | s "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : options.scenes) {
    if (auto status = run_scene(options, scene); !status) return status;
  }
  return {};
}

}  // namespace
}  // namespace waymark::bench

int main(int argc, char** argv) {
  CLI::App app("The paper's Table IV, measured");
  waymark::bench::Options options;
  app.add_option("captures", options.captures, "Folder for captures, kept for the next run")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--scenes", options.scenes)->delimiter(',');
  app.add_option("--rig", options.rig);
  app.add_option("--noise-px", options.noise_px, "Simulated detections instead of images")
      ->check(CLI::Range(0.0, 5.0));
  app.add_option("--positions", options.positions, "Along each way [the scene's]");
  CLI11_PARSE(app, argc, argv);
  const auto status = waymark::bench::run(options);
  if (status) return 0;
  fmt::print(stderr, "bench_weight_ablation: {}\n", status.error().message);
  return status.error().exit_code();
}
