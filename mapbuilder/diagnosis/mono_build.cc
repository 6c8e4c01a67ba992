#include "mapbuilder/diagnosis/mono_build.h"

#include <map>

namespace waymark {
namespace {

DetectedCapture thinned(DetectedCapture capture, std::size_t images_per_camera) {
  std::map<int, std::size_t> count;
  for (const ImageDetections& image : capture.images) {
    if (!image.detections.empty()) ++count[image.camera];
  }
  std::map<int, std::size_t> seen;
  std::erase_if(capture.images, [&](const ImageDetections& image) {
    if (image.detections.empty()) return true;
    const std::size_t every = 1 + count[image.camera] / (images_per_camera + 1);
    return seen[image.camera]++ % every != 0;
  });
  return capture;
}

}  // namespace

std::optional<MonoBuild> build_mono(const std::vector<DetectedCapture>& captures,
                                    const BuildOptions& options, Progress& progress) {
  auto observations = make_observations(captures, {true, options.threads});
  if (!observations) return std::nullopt;
  BuildOptions mono = options;
  mono.refine = {};
  mono.survey = {};
  MonoBuild build{*std::move(observations), {}, {}};
  const Selection selection(build.observations);
  build.result = build_map(selection, mono, progress);
  build.quality = fit_quality(selection, build.result);
  return build;
}

std::vector<DetectedCapture> thinned(std::vector<DetectedCapture> captures,
                                     std::size_t images_per_camera) {
  for (DetectedCapture& capture : captures) {
    capture = thinned(std::move(capture), images_per_camera);
  }
  return captures;
}

}  // namespace waymark
