/// Does the map's covariance tell the truth? Simulated detections with Gaussian noise, many seeds:
/// errors against the Cramér-Rao bound, and the joint error against the joint covariance that the
/// stored ones are the blocks of. Prints Markdown.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/chi_square.h"
#include "bench/scene_bound.h"
#include "bench/scene_trial.h"

namespace waymark::bench {
namespace {

struct Options {
  std::string work;
  std::vector<std::string> scenes = {"room1", "room2", "warehouse"};
  std::string rig = "cg120";
  int seeds = 100;
  double noise_px = 0.1;
};

constexpr double kQuantile = 0.99;
constexpr int kDraws = 4096;

/// One seed's errors, as multiples of the bound's expectation.
struct SeedResult {
  double markers = 0, marker_rotations = 0, rigs = 0, rigs_in_map = 0;
  double chi2 = 0;
  double freedom = 0;
  double block_difference = 0;  ///< of stored covariances from the joint one's blocks, relative
  double model_sigma_px = 0;
};

Expected<SeedResult> judge(const SceneCapture& capture, const SceneRmse& bound) {
  auto trial = map_scene(capture, {});
  if (!trial) return tl::make_unexpected(trial.error());
  if (trial->built.submaps.size() != 1 || !trial->markers.missing.empty() ||
      !trial->markers.errors || !trial->cameras.errors || !trial->cameras.rmse_in_map) {
    return fail(ErrorKind::bad_data, "{}: {} sub-maps, {} markers missing", capture.scene,
                trial->built.submaps.size(), trial->markers.missing.size());
  }
  const auto joint = joint_covariance(*trial);
  if (!joint) return tl::make_unexpected(joint.error());
  SeedResult result;
  result.markers = trial->markers.errors->rmse.translation_m / bound.markers.translation_m;
  result.marker_rotations = trial->markers.errors->rmse.rotation_rad / bound.markers.rotation_rad;
  result.rigs = trial->cameras.errors->rmse.translation_m / bound.rigs.translation_m;
  result.rigs_in_map = trial->cameras.rmse_in_map->translation_m / bound.rigs_in_map.translation_m;
  result.model_sigma_px = trial->built.submaps.front().model_sigma_px;

  const SubMap& map = trial->built.submaps.front().map;
  const Rigid3 map_from_truth = trial->markers.errors->truth_from_estimate.inverse();
  Eigen::VectorXd error(static_cast<Eigen::Index>(6 * map.markers.size()));
  const std::vector<Matrix6d> blocks = joint->marker_blocks();
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    const MapMarker& marker = map.markers[i];
    error.segment<6>(row) = marker.world_from_marker.minus(
        map_from_truth * capture.truth.world_from_marker->at(marker.id));
    result.block_difference = std::max(result.block_difference,
                                       (marker.covariance - blocks[i]).norm() / blocks[i].norm());
  }
  result.chi2 = joint->marker_chi2(error);
  result.freedom = static_cast<double>(joint->marker_freedom());
  return result;
}

/// "1.02 (1.31), 1 of 100 beyond 1.35".
std::string ratios(const std::vector<SeedResult>& results, double SeedResult::*part,
                   double quantile) {
  double squares = 0;
  double worst = 0;
  int beyond = 0;
  for (const SeedResult& result : results) {
    squares += result.*part * result.*part;
    worst = std::max(worst, result.*part);
    beyond += result.*part > quantile ? 1 : 0;
  }
  return fmt::format("{:.3f}, worst {:.2f}, {} beyond {:.2f}",
                     std::sqrt(squares / static_cast<double>(results.size())), worst, beyond,
                     quantile);
}

Status run_scene(const Options& options, const std::string& scene) {
  // Every seed sees the same markers from the same places: one bound for all.
  const auto first = simulated_detections(options.work, scene, options.rig, options.noise_px, 1, 0);
  if (!first) return tl::make_unexpected(first.error());
  auto trial = map_scene(*first, {});
  if (!trial) return tl::make_unexpected(trial.error());
  const auto scene_at_truth = true_scene(*first, *trial);
  if (!scene_at_truth) return tl::make_unexpected(scene_at_truth.error());
  const auto truth = bound_at_truth(*scene_at_truth, options.noise_px);
  if (!truth) return tl::make_unexpected(truth.error());
  const SceneRmse bound = truth->expected();
  const SceneRmse high = truth->quantile(kQuantile, kDraws, 1);

  std::vector<SeedResult> results;
  std::vector<double> probabilities;
  for (int seed = 1; seed <= options.seeds; ++seed) {
    const auto capture =
        simulated_detections(options.work, scene, options.rig, options.noise_px, seed, 0);
    if (!capture) return tl::make_unexpected(capture.error());
    const auto result = judge(*capture, bound);
    if (!result) return tl::make_unexpected(result.error());
    results.push_back(*result);
    probabilities.push_back(chi_square_cdf(result->chi2, result->freedom));
    fmt::print(stderr, "{} seed {}: error / bound {:.3f}, chi2 / freedom {:.3f}\n", scene, seed,
               result->markers, result->chi2 / result->freedom);
  }
  const double freedom = results.front().freedom;
  double mean = 0;
  double difference = 0;
  double sigma_px = 0;
  for (const SeedResult& result : results) {
    mean += result.chi2 / static_cast<double>(results.size());
    sigma_px += result.model_sigma_px / static_cast<double>(results.size());
    difference = std::max(difference, result.block_difference);
  }
  const double ks = kolmogorov_distance(probabilities);
  fmt::print(
      "| {} {} | {:.2f} mm / {:.4f} deg | {} | {} | {} | {} | {:.1f} / {:.0f} = {:.4f} | {:.3f}, "
      "p = {:.3f} | {:.1e} | {:.4f} |\n",
      scene, options.rig, 1e3 * bound.markers.translation_m,
      bound.markers.rotation_rad * 180 / M_PI,
      ratios(results, &SeedResult::markers,
             high.markers.translation_m / bound.markers.translation_m),
      ratios(results, &SeedResult::marker_rotations,
             high.markers.rotation_rad / bound.markers.rotation_rad),
      ratios(results, &SeedResult::rigs, high.rigs.translation_m / bound.rigs.translation_m),
      ratios(results, &SeedResult::rigs_in_map,
             high.rigs_in_map.translation_m / bound.rigs_in_map.translation_m),
      mean, freedom, mean / freedom, ks, kolmogorov_p(ks, results.size()), difference, sigma_px);
  return {};
}

Status run(const Options& options) {
  fmt::print(
      "{} seeds, {} px Gaussian per axis.\n\n| scene, rig | bound | marker positions: error "
      "/ bound, RMS | rotations | poses on poses | poses in the map | chi2 / freedom, mean | "
      "Kolmogorov-Smirnov | stored blocks off by | model sigma, px "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n",
      options.seeds, options.noise_px);
  for (const std::string& scene : options.scenes) {
    if (auto status = run_scene(options, scene); !status) return status;
  }
  return {};
}

}  // namespace
}  // namespace waymark::bench

int main(int argc, char** argv) {
  CLI::App app("Errors against the bound, and covariances against errors");
  waymark::bench::Options options;
  app.add_option("work", options.work, "Folder for captures; they are removed again")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--scenes", options.scenes)->delimiter(',');
  app.add_option("--rig", options.rig);
  app.add_option("--seeds", options.seeds)->check(CLI::Range(1, 10000));
  app.add_option("--noise-px", options.noise_px)->check(CLI::Range(0.001, 5.0));
  CLI11_PARSE(app, argc, argv);
  const auto status = waymark::bench::run(options);
  if (status) return 0;
  fmt::print(stderr, "bench_consistency: {}\n", status.error().message);
  return status.error().exit_code();
}
