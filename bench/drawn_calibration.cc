#include "bench/drawn_calibration.h"

#include <map>
#include <random>

#include "core/base/check.h"
#include "core/camera/lens_kind.h"
#include "core/estimate/consider_parameters.h"
#include "core/marker/marker_outline.h"

namespace waymark::bench {
namespace {

/// Takes one number's error out of a camera.
void take_out(const RigParameter& parameter, double error, RigCamera& camera) {
  CameraParameters lens = camera.model.parameters();
  Vector6d step = Vector6d::Zero();
  switch (parameter.quantity) {
    case CameraQuantity::position:
      step[parameter.axis] = -error;
      break;
    case CameraQuantity::rotation:
      step[3 + parameter.axis] = -error;
      break;
    case CameraQuantity::focal:
      lens.fu_px /= 1 + error;
      lens.fv_px /= 1 + error;
      break;
    case CameraQuantity::principal:
      (parameter.axis == 0 ? lens.pu_px : lens.pv_px) -= error;
      break;
    case CameraQuantity::k1:
      lens.coefficients[static_cast<std::size_t>(lens_kind(lens.distortion).first_bend)] -= error;
      break;
    default:
      return;
  }
  const auto model = CameraModel::create(lens);
  WAYMARK_CHECK(model);
  camera.model = *model;
  camera.rig_from_cam = camera.rig_from_cam.plus(step);
}

std::vector<StatedSize> sizes_of(const MarkerCatalog& catalog) {
  std::map<double, double> sigmas;
  for (const auto& entry : catalog.entries()) {
    if (entry.default_size_m) sigmas[*entry.default_size_m] = 0;
    for (const auto& [id, size_m] : entry.size_m_by_id) sigmas[size_m] = 0;
  }
  std::vector<StatedSize> sizes;
  for (const auto& [size_m, unused] : sigmas) {
    sizes.push_back({size_m, default_size_sigma_m(size_m) / size_m});
  }
  return sizes;
}

MarkerCatalog with_sizes(const MarkerCatalog& exact, const std::map<double, double>& errors) {
  std::vector<MarkerCatalog::FamilyEntry> entries = exact.entries();
  for (auto& entry : entries) {
    entry.default_size_sigma_m.reset();
    entry.size_sigma_m_by_id.clear();
    if (entry.default_size_m) *entry.default_size_m /= 1 + errors.at(*entry.default_size_m);
    for (auto& [id, size_m] : entry.size_m_by_id) size_m /= 1 + errors.at(size_m);
  }
  return MarkerCatalog(std::move(entries));
}

}  // namespace

DetectedCapture with_drawn_calibration(DetectedCapture exact, std::uint64_t seed) {
  for (RigCamera& camera : exact.rig.cameras) camera.stated_sigmas = {};
  const std::vector<Rig> rigs{exact.rig};
  const ConsiderParameters parameters = consider_parameters(rigs, sizes_of(exact.catalog));
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd unit(parameters.count());
  for (double& one : unit) one = normal(random);
  const Eigen::VectorXd errors = square_root_of(parameters.covariance) * unit;

  std::vector<double> outward_px(exact.rig.cameras.size(), 0.0);
  std::map<double, double> of_size;
  for (Eigen::Index i = 0; i < errors.size(); ++i) {
    const ConsiderParameter& one = parameters.all[static_cast<std::size_t>(i)];
    if (one.is_size()) {
      of_size[one.size_m] = errors[i];
    } else if (one.of_rig.quantity == CameraQuantity::edge) {
      outward_px[one.of_rig.camera] = errors[i];
    } else {
      take_out(one.of_rig, errors[i], exact.rig.cameras[one.of_rig.camera]);
    }
  }
  exact.catalog = with_sizes(exact.catalog, of_size);
  for (ImageDetections& image : exact.images) {
    const double by_px = outward_px[static_cast<std::size_t>(image.camera)];
    for (Detection& detection : image.detections) move_sides_in(-by_px, detection.corners);
  }
  return exact;
}

}  // namespace waymark::bench
