#include "mapbuilder/diagnosis/camera_alone.h"

#include <algorithm>

namespace waymark {
namespace {

/// Images that tell the intrinsics; of more, every n-th.
constexpr std::size_t kMaxImages = 60;
/// Starts that are refined.
constexpr std::size_t kMostRefined = 3;

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

CameraParameters scaled(CameraParameters p, double factor) {
  p.fu_px *= factor;
  p.fv_px *= factor;
  p.pu_px = (p.pu_px + 0.5) * factor - 0.5;
  p.pv_px = (p.pv_px + 0.5) * factor - 0.5;
  return p;
}

/// Cameras that a wrong file may hide.
std::vector<CameraParameters> starts_near(const CameraParameters& stated) {
  std::vector<CameraParameters> starts;
  CameraParameters turned = stated;
  turned.pu_px = stated.width_px - 1 - stated.pu_px;
  turned.pv_px = stated.height_px - 1 - stated.pv_px;
  starts.push_back(turned);
  CameraParameters straight = stated;
  straight.distortion = Distortion::none;
  straight.coefficients = {};
  starts.push_back(straight);
  CameraParameters order = stated;
  order.fu_px = stated.pu_px;
  order.fv_px = stated.pv_px;
  order.pu_px = stated.fu_px;
  order.pv_px = stated.fv_px;
  starts.push_back(order);
  for (const double factor : {0.25, 0.5, 2.0 / 3.0, 0.75, 4.0 / 3.0, 1.5, 2.0, 4.0}) {
    starts.push_back(scaled(stated, factor));
  }
  for (const double factor : {0.5, 0.65, 0.77, 0.9, 1.1, 1.3, 1.55, 2.0}) {
    CameraParameters focal = stated;
    focal.fu_px *= factor;
    focal.fv_px *= factor;
    starts.push_back(focal);
  }
  for (const double factor : {0.75, 4.0 / 3.0}) {
    CameraParameters squeezed = stated;
    squeezed.fv_px *= factor;
    starts.push_back(squeezed);
  }
  return starts;
}

}  // namespace

std::optional<CameraAlone> fit_camera_alone(const DetectedCapture& capture, std::size_t camera,
                                            const BuildOptions& options) {
  const DetectedCapture alone = camera_alone(capture, camera);
  const CameraParameters& stated = capture.rig.cameras[camera].model.parameters();
  const auto as_stated = attempt(alone, stated, options, false);
  if (!as_stated) return std::nullopt;
  CameraAlone result{as_stated->quality, as_stated->quality, stated};
  std::vector<Attempt> tried{*as_stated};
  if (as_stated->quality.contradicts()) {
    for (const CameraParameters& start : starts_near(stated)) {
      if (auto made = attempt(alone, start, options, false)) tried.push_back(*std::move(made));
    }
  }
  const auto better = [](const Attempt& a, const Attempt& b) {
    return a.quality.joint_px < b.quality.joint_px;
  };
  std::stable_sort(tried.begin(), tried.end(), better);
  tried.resize(std::min(tried.size(), kMostRefined));
  for (const Attempt& start : tried) {
    const auto refined = attempt(alone, start.parameters, options, true);
    for (const Attempt* made : {&start, refined ? &*refined : nullptr}) {
      if (made == nullptr || made->quality.joint_px >= result.fitted.joint_px) continue;
      result.fitted = made->quality;
      result.parameters = made->parameters;
    }
  }
  return result;
}

}  // namespace waymark
