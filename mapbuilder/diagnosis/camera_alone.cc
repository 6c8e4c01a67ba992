#include "mapbuilder/diagnosis/camera_alone.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mapbuilder/diagnosis/lens_of_squares.h"

namespace waymark {
namespace {

/// Images that tell the intrinsics; of more, every n-th.
constexpr std::size_t kMaxImages = 60;
/// Of a camera whose images make no map.
constexpr FitQuality kNoMap{std::numeric_limits<double>::infinity(),
                            std::numeric_limits<double>::infinity()};

DetectedCapture camera_alone(const DetectedCapture& capture, std::size_t camera) {
  DetectedCapture alone = capture;
  alone.rig.cameras = {capture.rig.cameras[camera]};
  alone.rig.cameras.front().rig_from_cam = Rigid3{};
  alone.images.clear();
  for (const ImageDetections& image : capture.images) {
    if (image.camera != static_cast<int>(camera) || image.detections.empty()) continue;
    alone.images.push_back(image);
    alone.images.back().camera = 0;
  }
  const std::size_t every = 1 + alone.images.size() / (kMaxImages + 1);
  std::vector<ImageDetections> spread;
  for (std::size_t i = 0; i < alone.images.size(); i += every) spread.push_back(alone.images[i]);
  alone.images = std::move(spread);
  return alone;
}

struct Attempt {
  CameraParameters parameters;
  FitQuality quality;
};

/// How well the images fit a camera; with `refine` one near it.
std::optional<Attempt> attempt(DetectedCapture alone, const CameraParameters& parameters,
                               BuildOptions options, bool refine) {
  auto model = CameraModel::create(parameters);
  if (!model) return std::nullopt;
  alone.rig.cameras.front().model = *std::move(model);
  const auto observations = make_observations({alone}, {true, options.threads});
  if (!observations || observations->usable == 0) return std::nullopt;
  options.survey = {};
  options.refine = {};
  options.refine.intrinsics = refine;
  // A diagnosis asks what fits best, not whether it is good enough for a map.
  options.refinement_limits = {1.0, 0.1, 0.1, 0.1, 100.0};
  Progress silent(false);
  const Selection selection(*observations);
  const BuildResult result = build_map(selection, options, silent);
  if (result.submaps.empty()) return std::nullopt;
  Attempt made{parameters, fit_quality(selection, result)};
  if (refine && result.calibration.refined) {
    made.parameters =
        result.estimate.calibration.rigs[RigIndex(0)].cameras.front().model.parameters();
  }
  return made;
}

/// The outlines that a camera has seen.
std::vector<ImageCorners> squares_of(const DetectedCapture& alone) {
  std::vector<ImageCorners> squares;
  for (const ImageDetections& image : alone.images) {
    for (const Detection& detection : image.detections) squares.push_back(detection.corners);
  }
  return squares;
}

}  // namespace

std::optional<CameraAlone> fit_camera_alone(const DetectedCapture& capture, std::size_t camera,
                                            const BuildOptions& options) {
  const DetectedCapture alone = camera_alone(capture, camera);
  const CameraParameters& stated = capture.rig.cameras[camera].model.parameters();
  const auto as_stated = attempt(alone, stated, options, false);
  const auto by_squares = lens_of_squares(stated, squares_of(alone));
  if (!as_stated && !by_squares) return std::nullopt;
  CameraAlone result{kNoMap, kNoMap, stated};
  if (as_stated) result.stated = result.fitted = as_stated->quality;
  const auto take = [&](const std::optional<Attempt>& made) {
    if (!made || made->quality.joint_px >= result.fitted.joint_px) return;
    result.fitted = made->quality;
    result.parameters = made->parameters;
  };
  take(attempt(alone, stated, options, true));
  if (by_squares) {
    // What corners are worth is told by the lens that fits them, not by one that spoils them.
    take(attempt(alone, by_squares->parameters, options, false));
    take(attempt(alone, by_squares->parameters, options, true));
    result.stated.own_px = std::min(result.stated.own_px, by_squares->own_px);
    result.fitted.own_px = std::min(result.fitted.own_px, by_squares->own_px);
  }
  if (!std::isfinite(result.fitted.joint_px)) return std::nullopt;
  return result;
}

}  // namespace waymark
