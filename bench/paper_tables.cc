/// Tables II and III of the paper on the simulator's scenes: renders, maps, and sets the accuracy
/// beside the paper's and beside what was possible. Prints Markdown.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "bench/paper_figures.h"
#include "bench/scene_bound.h"
#include "bench/scene_trial.h"

namespace waymark::bench {
namespace {

struct Row {
  std::string scene, rig, level;
  SceneCapture capture;
  SceneTrial trial;
  CornerVerdict verdict;
};

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// "2.31 / 0.041": mm and degrees.
std::string text(const PoseRmse& rmse) {
  return fmt::format("{:.2f} / {:.4f}", 1e3 * rmse.translation_m, degrees(rmse.rotation_rad));
}

/// Whether an error is at most 1.5 times its bound plus what the edge bias explains.
bool within(const PoseRmse& error, const PoseRmse& bound, const PoseRmse& bias) {
  return error.translation_m <= kMostBounds * bound.translation_m + bias.translation_m &&
         error.rotation_rad <= kMostBounds * bound.rotation_rad + bias.rotation_rad;
}

const char* verdict(bool met) { return met ? "yes" : "**no**"; }

void print_markers(const std::vector<Row>& rows) {
  fmt::print(
      "\n| scene, rig | markers | sub-maps | paper, mm / deg | measured, mm / deg | bound | edge "
      "bias explains | these corners, least squares | scale - 1, ppm | Sim(3), mm | bar | <= 1.5 "
      "bounds + bias |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Row& row : rows) {
    const SceneTrial& trial = row.trial;
    const CornerVerdict& possible = row.verdict;
    if (!trial.markers.errors) continue;
    const PoseAccuracy& errors = *trial.markers.errors;
    const auto paper = paper_row(row.scene, row.rig);
    const double bar_m = marker_bar_m(row.scene);
    const bool met = errors.rmse.translation_m <= bar_m &&
                     degrees(errors.rmse.rotation_rad) <= kMarkerBar_deg &&
                     trial.built.submaps.size() == 1 && trial.markers.missing.empty();
    fmt::print(
        "| {} {} | {}/{} | {} | {} | **{}** | {} | {} | {} | {:+.0f} | {:.2f} | {:.0f} / "
        "{}: {} | {} |\n",
        row.scene, row.rig, trial.markers.found.size(), trial.true_markers,
        trial.built.submaps.size(),
        paper ? fmt::format("{:.0f} / {:.3f}", 1e3 * paper->marker_m, paper->marker_deg) : "-",
        text(errors.rmse), text(possible.bound.markers), text(possible.by_bias.markers),
        text(possible.by_corners.markers), 1e6 * (errors.scale - 1),
        1e3 * errors.sim3_translation_rmse_m, 1e3 * bar_m, kMarkerBar_deg, verdict(met),
        verdict(within(errors.rmse, possible.bound.markers, possible.by_bias.markers)));
  }
}

void print_cameras(const std::vector<Row>& rows) {
  fmt::print(
      "\n| scene, rig | poses | paper, mm / deg | on cameras, mm / deg | bound | bias | bar | <= "
      "1.5 bounds + bias | in the map, mm / deg | bound | bias | <= 1.5 bounds + bias | scale - 1, "
      "ppm | Sim(3), mm |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Row& row : rows) {
    const SceneTrial& trial = row.trial;
    if (!trial.cameras.errors || !trial.cameras.rmse_in_map) continue;
    const CornerVerdict& possible = row.verdict;
    const PoseAccuracy& errors = *trial.cameras.errors;
    const auto paper = paper_row(row.scene, row.rig);
    const PoseRmse& bound = possible.bound.rigs;
    const bool mono = row.rig == "mono";
    const double bar_m = mono ? kMonoCameraBounds * bound.translation_m : camera_bar_m(row.scene);
    const double bar_deg = mono ? kMonoCameraBounds * degrees(bound.rotation_rad) : kCameraBar_deg;
    const bool met =
        errors.rmse.translation_m <= bar_m && degrees(errors.rmse.rotation_rad) <= bar_deg;
    fmt::print(
        "| {} {} | {}/{} | {} | **{}** | {} | {} | {:.1f} / {:.3f}: {} | {} | **{}** | {} | "
        "{} | {} | {:+.0f} | {:.2f} |\n",
        row.scene, row.rig, trial.cameras.found, trial.frame_sets,
        paper ? fmt::format("{:.0f} / {:.3f}", 1e3 * paper->camera_m, paper->camera_deg) : "-",
        text(errors.rmse), text(bound), text(possible.by_bias.rigs), 1e3 * bar_m, bar_deg,
        verdict(met), verdict(within(errors.rmse, bound, possible.by_bias.rigs)),
        text(*trial.cameras.rmse_in_map), text(possible.bound.rigs_in_map),
        text(possible.by_bias.rigs_in_map),
        verdict(within(*trial.cameras.rmse_in_map, possible.bound.rigs_in_map,
                       possible.by_bias.rigs_in_map)),
        1e6 * (errors.scale - 1), 1e3 * errors.sim3_translation_rmse_m);
  }
}

/// Images to map on two cores that do nothing else: images are searched side by side, the rest is
/// taken as one thread's.
double on_two_free_cores_s(const Row& row) {
  return 0.5 * row.capture.detection.cpu_s + row.trial.mapping.cpu_s;
}

void print_inputs(const std::vector<Row>& rows) {
  fmt::print(
      "\n| scene, rig | images | observations | rejected | misread | sigma, px per axis | edge "
      "bias, px | ambiguous sets | paper, s | detect + map, s | CPU, s | on two free cores, s | "
      "paper / that | <= 1/20 |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Row& row : rows) {
    const SceneTrial& trial = row.trial;
    const BuiltSubMap& first = trial.built.submaps.front();
    const double ours_s = on_two_free_cores_s(row);
    const auto paper = paper_row(row.scene, row.rig);
    fmt::print(
        "| {} {} | {} | {} | {} | {} | {:.4f} | {:+.4f} | {} | {} | {:.1f} + {:.1f} | {:.1f} + "
        "{:.1f} | {:.1f} | {} | {} |\n",
        row.scene, row.rig, row.capture.images, row.verdict.observations, first.rejected,
        row.verdict.misread, row.verdict.corners.sigma_px, row.verdict.corners.edge_bias_px,
        first.ambiguous.size(), paper ? fmt::format("{:.0f}", paper->time_s) : "-",
        row.capture.detection.wall_s, trial.mapping.wall_s, row.capture.detection.cpu_s,
        trial.mapping.cpu_s, ours_s, paper ? fmt::format("{:.0f}", paper->time_s / ours_s) : "-",
        paper ? verdict(ours_s <= kMostOfPapersTime * paper->time_s) : "-");
  }
}

struct Options {
  std::string captures;
  std::string level = "still";
  std::vector<std::string> scenes = {"room1",    "room2",     "pool",
                                     "corridor", "warehouse", "calibration"};
  std::vector<std::string> rigs = {"cg60", "cg120", "mono"};
  int positions = 0;
};

Status run(const Options& options) {
  std::vector<Row> rows;
  std::filesystem::path capture_folder;
  Expected<SceneCapture> capture;
  for (const std::string& scene : options.scenes) {
    for (const std::string& rig : options.rigs) {
      const auto folder =
          rendered_capture(options.captures, scene, rig, options.level, options.positions);
      if (!folder) return tl::make_unexpected(folder.error());
      // Mono and CG-120 are the same images: they are searched once.
      if (!capture || capture_folder != *folder) {
        capture = take_capture(*folder, scene, rig);
        capture_folder = *folder;
      }
      if (!capture) return tl::make_unexpected(capture.error());
      capture->rig = rig;
      capture->mono = rig == "mono";
      auto trial = map_scene(*capture, {});
      if (!trial) return tl::make_unexpected(trial.error());
      const auto verdict = judge_corners(*capture, *trial);
      if (!verdict) return tl::make_unexpected(verdict.error());
      rows.push_back({scene, rig, options.level, *capture, *std::move(trial), *verdict});
      const Row& row = rows.back();
      fmt::print(stderr, "{} {}: markers {}, bound {}, these corners {}\n", scene, rig,
                 row.trial.markers.errors ? text(row.trial.markers.errors->rmse) : "-",
                 text(verdict->bound.markers), text(verdict->by_corners.markers));
    }
  }
  fmt::print("Level {}.\n", options.level);
  print_markers(rows);
  print_cameras(rows);
  print_inputs(rows);
  return {};
}

}  // namespace
}  // namespace waymark::bench

int main(int argc, char** argv) {
  CLI::App app("The paper's Tables II and III, measured");
  waymark::bench::Options options;
  app.add_option("captures", options.captures,
                 "Folder for rendered captures, kept for the next run")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--level", options.level)->check(CLI::IsMember({"still", "drive"}));
  app.add_option("--scenes", options.scenes)->delimiter(',');
  app.add_option("--rigs", options.rigs)->delimiter(',');
  app.add_option("--positions", options.positions, "Along each way [the scene's]");
  CLI11_PARSE(app, argc, argv);
  const auto status = waymark::bench::run(options);
  if (status) return 0;
  fmt::print(stderr, "bench_paper_tables: {}\n", status.error().message);
  return status.error().exit_code();
}
