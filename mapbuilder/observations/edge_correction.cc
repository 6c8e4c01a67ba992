#include "mapbuilder/observations/edge_correction.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/parallel.h"
#include "core/capture/image_file.h"
#include "core/marker/marker_bits.h"
#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

/// Of more markers, so many are fitted, spread evenly over the capture.
constexpr std::size_t kMostMarkers = 120;

/// A detection by its place in the capture.
struct Chosen {
  std::size_t detection = 0;  ///< in its image
  std::optional<MarkerFits> fits;
};

/// By image of the capture, rising.
using ChosenMarkers = std::map<std::size_t, std::vector<Chosen>>;

/// Every measured camera's markers that are read without a wrong cell, thinned.
ChosenMarkers choose(const DetectedCapture& detected) {
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> by_camera(
      detected.rig.cameras.size());
  for (std::size_t i = 0; i < detected.images.size(); ++i) {
    const ImageDetections& image = detected.images[i];
    if (states_edges(detected.rig.cameras[static_cast<std::size_t>(image.camera)])) continue;
    for (std::size_t k = 0; k < image.detections.size(); ++k) {
      const Detection& detection = image.detections[k];
      // Black that is too small makes squares of black smaller and those of white larger.
      if (detected.catalog.shows_light_squares(detection.marker.family)) continue;
      if (detection.hamming > 0) continue;
      by_camera[static_cast<std::size_t>(image.camera)].emplace_back(i, k);
    }
  }
  ChosenMarkers chosen;
  for (const auto& markers : by_camera) {
    const std::size_t count = std::min(markers.size(), kMostMarkers);
    for (std::size_t i = 0; i < count; ++i) {
      const auto& [image, detection] = markers[i * markers.size() / count];
      chosen[image].push_back({detection, std::nullopt});
    }
  }
  return chosen;
}

/// Where the images of a capture lie.
std::map<std::pair<Stamp, int>, const ImageFile*> files_of(const CaptureFolder& capture) {
  std::map<std::pair<Stamp, int>, const ImageFile*> files;
  for (const ImageFile& file : capture.images) files[{file.stamp, file.camera}] = &file;
  return files;
}

void fit_image(const ImageFile& file, const ImageDetections& image, const CameraModel& camera,
               std::vector<Chosen>& markers) {
  const CameraParameters& expected = camera.parameters();
  const auto loaded = read_gray_image(file.path, ImageSize{expected.width_px, expected.height_px});
  if (!loaded) return;
  for (Chosen& one : markers) {
    const Detection& detection = image.detections[one.detection];
    one.fits =
        fit_marker(loaded->image.view(), camera, detection.corners, marker_bits(detection.marker));
  }
}

/// Reads the chosen markers' images again, a batch at a time, and fits them.
void fit(const CaptureFolder& capture, const DetectedCapture& detected, int threads,
         Progress& progress, ChosenMarkers& chosen) {
  std::vector<std::pair<std::size_t, std::vector<Chosen>*>> images;
  for (auto& [image, markers] : chosen) images.emplace_back(image, &markers);
  const auto files = files_of(capture);
  const std::size_t batch = static_cast<std::size_t>(effective_threads(threads)) * 4;
  progress.begin("measuring edges", images.size());
  for (std::size_t first = 0; first < images.size(); first += batch) {
    const std::size_t count = std::min(batch, images.size() - first);
    parallel_for(count, threads, [&](std::size_t i) {
      const auto& [index, markers] = images[first + i];
      const ImageDetections& image = detected.images[index];
      const auto file = files.find({image.stamp, image.camera});
      if (file == files.end()) return;
      const auto camera = static_cast<std::size_t>(image.camera);
      fit_image(*file->second, image, detected.rig.cameras[camera].model, *markers);
    });
    progress.update(first + count, "");
  }
  progress.end();
}

/// What the fits tell of each camera.
std::vector<std::optional<EdgeBias>> biases_of(const DetectedCapture& detected,
                                               const ChosenMarkers& chosen) {
  std::vector<std::vector<EdgeSample>> samples(detected.rig.cameras.size());
  for (const auto& [image, markers] : chosen) {
    const auto camera = static_cast<std::size_t>(detected.images[image].camera);
    for (const Chosen& one : markers) {
      if (one.fits) samples[camera].push_back({*one.fits, image});
    }
  }
  std::vector<std::optional<EdgeBias>> biases;
  biases.reserve(samples.size());
  for (std::size_t c = 0; c < samples.size(); ++c) {
    biases.push_back(edge_bias(samples[c], detected.rig.cameras[c].response));
  }
  return biases;
}

std::optional<EdgeMeasurement> measured(const std::optional<EdgeBias>& bias) {
  if (!bias) return std::nullopt;
  return EdgeMeasurement{bias->inset_px, bias->sigma_px, bias->response};
}

/// Moves an image's corners outward: fitted markers by their own inset, the others by the mean.
void move_corners(const MarkerCatalog& catalog, const std::vector<Chosen>& fitted,
                  const EdgeBias& bias, ImageDetections& image) {
  std::vector<double> insets;
  for (const Detection& detection : image.detections) {
    const bool light = catalog.shows_light_squares(detection.marker.family);
    insets.push_back(light ? -bias.inset_px : bias.inset_px);
  }
  for (const Chosen& one : fitted) {
    if (one.fits) insets[one.detection] = inset_of(*one.fits, bias);
  }
  for (std::size_t i = 0; i < insets.size(); ++i) {
    move_sides_in(-insets[i], image.detections[i].corners);
  }
}

}  // namespace

bool states_edges(const RigCamera& camera) {
  const auto& sigma_px = camera.stated_sigmas.edge_px;
  return camera.edge_bias_px || (sigma_px && *sigma_px < kSurestEdges_px);
}

std::vector<std::optional<EdgeBias>> correct_edges(const CaptureFolder& capture,
                                                   DetectedCapture& detected, int threads,
                                                   Progress& progress) {
  ChosenMarkers chosen = choose(detected);
  fit(capture, detected, threads, progress, chosen);
  auto biases = biases_of(detected, chosen);
  for (const auto& bias : biases) detected.edges.push_back(measured(bias));
  for (std::size_t i = 0; i < detected.images.size(); ++i) {
    ImageDetections& image = detected.images[i];
    const auto& bias = biases[static_cast<std::size_t>(image.camera)];
    if (bias) move_corners(detected.catalog, chosen[i], *bias, image);
  }
  return biases;
}

std::string edges_text(const std::string& camera, const std::optional<EdgeBias>& bias) {
  if (!bias) {
    return fmt::format(
        "{}: its markers do not tell how far edges are seen inside the black (fewer than eight "
        "clear "
        "ones, or not as their family is printed); its corners stay as they are",
        camera);
  }
  const std::string response =
      bias->response ? fmt::format("{} response", to_string(*bias->response))
                     : fmt::format("response not told, sRGB by {:.0f} %", 100 * bias->srgb_share);
  return fmt::format("{}: edges {:+.3f} ± {:.3f} px inside the black, corrected ({} markers, {})",
                     camera, bias->inset_px, bias->sigma_px, bias->markers, response);
}

}  // namespace waymark
