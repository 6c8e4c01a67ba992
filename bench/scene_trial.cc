#include "bench/scene_trial.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>

#include "bench/processor_time.h"
#include "core/base/progress.h"
#include "core/capture/capture_folder.h"
#include "core/geometry/tum.h"
#include "mapbuilder/observations/detect_capture.h"
#include "simulator/render_capture.h"
#include "simulator/rig_library.h"
#include "simulator/scene_library.h"
#include "simulator/simulate_detections.h"

namespace waymark::bench {
namespace {

namespace fs = std::filesystem;

/// Measures from its construction on.
class Stopwatch {
 public:
  [[nodiscard]] StageTime elapsed() const {
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - wall_;
    return {wall.count(), processor_s() - cpu_};
  }

 private:
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  double cpu_ = processor_s();
};

/// The first sub-map's trajectory as an evaluation takes it.
std::vector<Trajectory> trajectories_of(const Observations& observations,
                                        const SceneCapture& capture,
                                        const std::vector<LocalizedFrameSet>& localized) {
  std::map<std::optional<int>, Trajectory> by_camera;
  for (const LocalizedFrameSet& set : localized) {
    const ObservedFrameSet& known = observations.frame_sets[set.frame_set];
    Trajectory& trajectory = by_camera[known.mono_camera];
    if (capture.mono) trajectory.camera = fmt::format("cam{}", known.mono_camera.value_or(0));
    trajectory.poses.push_back({known.stamp, set.world_from_rig});
  }
  std::vector<Trajectory> trajectories;
  for (auto& [camera, trajectory] : by_camera) trajectories.push_back(std::move(trajectory));
  return trajectories;
}

}  // namespace

Expected<fs::path> rendered_capture(const fs::path& captures, const std::string& scene,
                                    const std::string& rig, const std::string& level,
                                    int positions) {
  const std::string imaged = rig == "mono" ? "cg120" : rig;
  const fs::path folder =
      captures / fmt::format("{}-{}-{}{}", scene, imaged, level,
                             positions > 0 ? fmt::format("-{}", positions) : std::string());
  std::error_code ignored;
  if (fs::exists(folder, ignored)) return folder;
  const auto building = simulator::load_scene(scene);
  if (!building) return tl::make_unexpected(building.error());
  const auto mounted = simulator::load_rig(imaged);
  if (!mounted) return tl::make_unexpected(mounted.error());
  simulator::RenderJob job;
  job.positions = positions;
  job.settings = level == "drive" ? simulator::drive_level() : simulator::still_level();
  const std::atomic<bool> stop{false};
  const auto rendered = simulator::render_capture(*building, *mounted, job, folder, stop);
  if (!rendered) return tl::make_unexpected(rendered.error());
  return folder;
}

Expected<SceneCapture> take_capture(const fs::path& folder, const std::string& scene,
                                    const std::string& rig) {
  SceneCapture capture;
  capture.scene = scene;
  capture.rig = rig;
  capture.mono = rig == "mono";
  const auto opened = open_capture_folder(folder);
  if (!opened) return tl::make_unexpected(opened.error());
  Progress progress(false);
  DetectionReport report;
  const Stopwatch stopwatch;
  auto detected = detect_capture(*opened, {}, progress, report);
  if (!detected) return tl::make_unexpected(detected.error());
  capture.detection = stopwatch.elapsed();
  capture.images = report.images;
  capture.detected = *std::move(detected);
  auto truth = read_ground_truth(folder / "groundtruth", capture.detected.catalog.only_family());
  if (!truth) return tl::make_unexpected(truth.error());
  if (!truth->world_from_marker || !truth->world_from_rig) {
    return fail(ErrorKind::no_input, "{}: the truth of markers or rig is absent", folder.string());
  }
  capture.truth = *std::move(truth);
  return capture;
}

Expected<SceneCapture> simulated_detections(const fs::path& work, const std::string& scene,
                                            const std::string& rig, double noise_px, int seed,
                                            int positions) {
  const fs::path folder = work / fmt::format("{}-{}-{}px-{}", scene, rig, noise_px, seed);
  const auto building = simulator::load_scene(scene);
  if (!building) return tl::make_unexpected(building.error());
  const auto mounted = simulator::load_rig(rig);
  if (!mounted) return tl::make_unexpected(mounted.error());
  simulator::DetectionsJob job;
  job.positions = positions;
  job.noise_px = noise_px;
  job.seed = static_cast<std::uint64_t>(seed);
  job.show_progress = false;
  const std::atomic<bool> stop{false};
  const auto simulated = simulator::simulate_detections(*building, *mounted, job, folder, stop);
  if (!simulated) return tl::make_unexpected(simulated.error());
  auto capture = take_capture(folder, scene, rig);
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  return capture;
}

Expected<SceneTrial> map_scene(const SceneCapture& capture, const BuildOptions& options) {
  SceneTrial trial;
  Progress progress(false);
  const Stopwatch stopwatch;
  std::vector<DetectedCapture> captures = {capture.detected};
  auto observations = make_observations(captures, {capture.mono, options.threads});
  if (!observations) return tl::make_unexpected(observations.error());
  trial.observations = *std::move(observations);
  trial.built = build_map(Selection(trial.observations), options, progress);
  trial.mapping = stopwatch.elapsed();
  if (trial.built.submaps.empty()) {
    return fail(ErrorKind::bad_data, "{} {}: no map", capture.scene, capture.rig);
  }
  trial.true_markers = capture.truth.world_from_marker->size();
  trial.frame_sets = static_cast<std::size_t>(
      std::count_if(trial.observations.frame_sets.begin(), trial.observations.frame_sets.end(),
                    [](const ObservedFrameSet& set) { return !set.observations.empty(); }));
  const BuiltSubMap& first = trial.built.submaps.front();
  trial.markers = evaluate_markers(first.map, *capture.truth.world_from_marker);
  const auto poses =
      match_with_truth(trajectories_of(trial.observations, capture, first.trajectory),
                       *capture.truth.world_from_rig, &capture.detected.rig);
  if (!poses) return tl::make_unexpected(poses.error());
  trial.cameras = evaluate_cameras(*poses, &trial.markers);
  return trial;
}

}  // namespace waymark::bench
