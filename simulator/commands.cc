#include "simulator/commands.h"

#include <fmt/ostream.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <set>

#include "core/base/one_line.h"
#include "core/base/range.h"
#include "simulator/rig_library.h"
#include "simulator/scene_library.h"

namespace waymark::simulator {
namespace {

int report(const Error& error) {
  fmt::print(std::cerr, "simulator: {}\n", error.message);
  return error.exit_code();
}

/// Options that both kinds of capture have.
template <typename Options>
void add_capture_options(CLI::App& command, Options& options) {
  command.add_option("--scene", options.scene, "Scene by name (see list) or a scene file")
      ->required();
  command.add_option("--rig", options.rig, "mono, cg60, cg120, cg180 or a Kalibr camchain file")
      ->required();
  command.add_option("-o,--output", options.output, "Capture folder to be made; must not exist")
      ->required();
  command.add_option("--positions", options.job.positions, "Positions along the way [the scene's]")
      ->check(CLI::Range(1, 1'000'000));
  command.add_option("--speed-mps", options.speed_mps, "Along the way [the scene's]")
      ->check(number_in({0.001, 50}));
  command.add_option("--seed", options.job.seed, "Of everything random")->capture_default_str();
  command.add_option("--threads", options.job.threads, "0: all processors")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

RenderSettings settings_of(const RenderOptions& options) {
  RenderSettings settings = options.level == "drive" ? drive_level() : still_level();
  settings.response = options.response == "srgb" ? Response::srgb : Response::linear;
  settings.png = options.format == "png";
  settings.noise = !options.no_noise;
  settings.psf_sigma_px = options.psf_sigma_px.value_or(settings.psf_sigma_px);
  settings.defocus_sigma_px = options.defocus_sigma_px.value_or(settings.defocus_sigma_px);
  settings.vignetting = options.vignetting.value_or(settings.vignetting);
  settings.texture_contrast = options.texture_contrast.value_or(settings.texture_contrast);
  settings.white_level = options.white_level.value_or(settings.white_level);
  if (options.exposure_ms) settings.exposure_s = *options.exposure_ms * 1e-3;
  if (options.readout_ms) settings.readout_s = *options.readout_ms * 1e-3;
  return settings;
}

}  // namespace

void add_render_command(CLI::App& app, RenderOptions& options) {
  auto* render = app.add_subcommand("render", "Images of a scene, as a rig takes them on its way");
  add_capture_options(*render, options);
  render
      ->add_option("--level", options.level,
                   "still: standing, global shutter; drive: blur, rolling shutter, stamp skew")
      ->check(CLI::IsMember({"still", "drive"}))
      ->capture_default_str();
  render->add_option("--format", options.format, "jpg (quality 95) or png")
      ->check(CLI::IsMember({"jpg", "png"}))
      ->capture_default_str();
  render->add_option("--jpeg-quality", options.job.settings.jpeg_quality, "1 to 100")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  render->add_option("--response", options.response, "Sensor: linear or srgb")
      ->check(CLI::IsMember({"linear", "srgb"}))
      ->capture_default_str();
  const auto tune = [render](const char* name, std::optional<double>& value, double low,
                             double high, const char* help) {
    render->add_option(name, value, help)->check(number_in({low, high}));
  };
  tune("--psf-sigma-px", options.psf_sigma_px, 0.3, 5, "Lens blur [0.7]");
  tune("--defocus-sigma-px", options.defocus_sigma_px, 0, 5, "Further blur, in quadrature [0]");
  tune("--exposure-ms", options.exposure_ms, 0, 100, "Motion blur [still 0, drive 4]");
  tune("--readout-ms", options.readout_ms, 0, 200, "Rolling shutter [still 0, drive 12]");
  tune("--vignetting", options.vignetting, 0, 0.95, "Light lost in the corners, share [0.35]");
  tune("--texture-contrast", options.texture_contrast, 0, 0.5, "Of walls, sigma/mean [0.22]");
  tune("--white-level", options.white_level, 10, 1000, "Grey level of lit paper [205]");
  render->add_flag("--no-noise", options.no_noise, "Neither shot nor read noise");
}

void add_detections_command(CLI::App& app, DetectionsOptions& options) {
  auto* detections =
      app.add_subcommand("detections", "True corners with noise and errors, without images");
  add_capture_options(*detections, options);
  const auto rate = [detections](const char* name, double& value, const char* help) {
    detections->add_option(name, value, help)->check(number_in({0, 1}))->capture_default_str();
  };
  const auto count = [detections](const char* name, int& value, const char* help) {
    detections->add_option(name, value, help)->check(CLI::Range(0, 10000))->capture_default_str();
  };
  detections->add_option("--noise-px", options.job.noise_px, "Gaussian, per axis of each corner")
      ->check(number_in({0, 10}))
      ->capture_default_str();
  rate("--miss-rate", options.job.miss_rate, "Share of visible markers not found");
  rate("--false-rate", options.job.false_rate, "Share of detections with a wrong id");
  rate("--drop-out-rate", options.job.drop_out_rate, "Share of images lost");
  count("--moved", options.job.moved, "Markers that are moved half-way");
  count("--twins", options.job.twins, "Ids that hang in two places");
  count("--mis-sized", options.job.mis_sized, "Markers of another size than stated");
  detections
      ->add_option(
          "--stamp-skew-ms", options.stamp_skew_ms,
          "Sigma by which cameras expose at another instant than the set's; the rig drives")
      ->check(number_in({0, 100}))
      ->capture_default_str();
}

int run_list() {
  fmt::print(std::cout, "{:<12} {:<18} {:>7}  {:<16} {:>9}  {:<18} {:>6}\n", "scene", "title",
             "markers", "sizes_m", "positions", "room_m", "way_m");
  for (const BuiltinScene& builtin : builtin_scenes()) {
    const auto scene = load_scene(std::string(builtin.name));
    if (!scene) return report(scene.error());
    std::set<double> sizes_m;
    for (const PlacedMarker& marker : scene->markers) sizes_m.insert(marker.size_m);
    const Eigen::Vector3d& room = scene->room_size_m;
    fmt::print(std::cout, "{:<12} {:<18} {:>7}  {:<16} {:>9}  {:<18} {:>6.1f}\n", scene->name,
               scene->title, scene->markers.size(), fmt::format("{}", fmt::join(sizes_m, " ")),
               scene->trajectory.positions,
               fmt::format("{} x {} x {}", room.x(), room.y(), room.z()),
               Trajectory(scene->trajectory).length_m());
  }
  fmt::print(std::cout, "rigs: mono cg60 cg120 cg180, or a camchain file\n");
  return 0;
}

int run_render(const RenderOptions& options, const std::atomic<bool>& stop) {
  auto scene = load_scene(options.scene);
  if (!scene) return report(scene.error());
  scene->trajectory.speed_mps = options.speed_mps.value_or(scene->trajectory.speed_mps);
  const auto rig = load_rig(options.rig);
  if (!rig) return report(rig.error());
  RenderJob job = options.job;
  const int jpeg_quality = job.settings.jpeg_quality;
  job.settings = settings_of(options);
  job.settings.jpeg_quality = jpeg_quality;
  const auto result = render_capture(*scene, *rig, job, options.output, stop);
  if (!result) return report(result.error());
  fmt::print(std::cout, "{}: {} images, {:.1f} images/s\n", in_one_line(options.output),
             result->images, static_cast<double>(result->images) / std::max(result->seconds, 1e-3));
  return 0;
}

int run_detections(const DetectionsOptions& options, const std::atomic<bool>& stop) {
  auto scene = load_scene(options.scene);
  if (!scene) return report(scene.error());
  scene->trajectory.speed_mps = options.speed_mps.value_or(scene->trajectory.speed_mps);
  const auto rig = load_rig(options.rig);
  if (!rig) return report(rig.error());
  DetectionsJob job = options.job;
  job.stamp_skew_sigma_s = options.stamp_skew_ms * 1e-3;
  const auto result = simulate_detections(*scene, *rig, job, options.output, stop);
  if (!result) return report(result.error());
  fmt::print(std::cout, "{}: {} images, {} detections\n", in_one_line(options.output),
             result->images, result->detections);
  return 0;
}

}  // namespace waymark::simulator
