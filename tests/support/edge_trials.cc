#include "tests/support/edge_trials.h"

#include <ctime>
#include <numbers>
#include <random>
#include <vector>

namespace waymark::testing {
namespace {

/// A marker somewhere in the image.
RenderedMarker drawn_marker(const CameraModel& camera, const EdgeTrials& trials,
                            std::mt19937_64& random) {
  const auto between = [&](double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random);
  };
  constexpr double kRadPerDeg = std::numbers::pi / 180;
  RenderedMarker marker;
  marker.id = {Family::tag36h11, static_cast<int>(random() % 587)};
  MarkerView view;
  view.mean_side_px = between(trials.min_side_px, trials.max_side_px);
  view.tilt_rad = kRadPerDeg * between(0, trials.max_tilt_deg);
  view.azimuth_rad = between(0, 2 * std::numbers::pi);
  view.roll_rad = between(0, 2 * std::numbers::pi);
  const double margin = 1.2 * view.mean_side_px + 10;
  const CameraParameters& size = camera.parameters();
  view.center_px = {between(margin, size.width_px - margin),
                    between(margin, size.height_px - margin)};
  marker.cam_from_marker = pose_seen_as(camera, view, marker.size_m);
  return marker;
}

double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

MeasuredEdges measure_edges(const CameraModel& camera, const EdgeTrials& trials) {
  std::mt19937_64 random(trials.image.seed);
  std::vector<EdgeSample> samples;
  std::vector<double> truths;
  MeasuredEdges result;
  for (int i = 0; i < trials.images; ++i) {
    const RenderedMarker marker = drawn_marker(camera, trials, random);
    RenderOptions options = trials.image;
    options.seed = random();
    options.psf_sigma_px *=
        1 + trials.blur_varies * std::uniform_real_distribution<double>(-1, 1)(random);
    const GrayImage image = render_markers(camera, {&marker, 1}, options);
    const MarkerBits bits = marker_bits(marker.id);
    const ImageCorners truth = true_corners(camera, marker);
    const auto refined = refine_corners(image.view(), camera, truth, bits);
    if (!refined) continue;
    const double begin = processor_ms();
    const auto fits = fit_marker(image.view(), camera, refined->corners, bits);
    result.mean_fit_ms += processor_ms() - begin;
    if (!fits) continue;
    samples.push_back({*fits, static_cast<std::size_t>(i)});
    truths.push_back(inset_px(refined->corners, truth));
  }
  const auto count = static_cast<double>(samples.size());
  result.mean_fit_ms /= count;
  result.measured = edge_bias(samples);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    result.true_inset_px += truths[i] / count;
    if (result.measured) {
      result.corrected_px += (truths[i] - inset_of(samples[i].fits, *result.measured)) / count;
    }
  }
  return result;
}

}  // namespace waymark::testing
