#include "core/camera/rig_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "core/camera/lens_kind.h"

namespace waymark {
namespace {

constexpr double kDegPerRad = 180 / std::numbers::pi;

/// How many axes a quantity has.
int axes_of(CameraQuantity quantity) {
  switch (quantity) {
    case CameraQuantity::position:
    case CameraQuantity::rotation:
      return 3;
    case CameraQuantity::principal:
      return 2;
    default:
      return 1;
  }
}

/// Whether it can be wrong of this camera.
bool has(const RigCamera& camera, CameraQuantity quantity) {
  switch (quantity) {
    case CameraQuantity::position:
    case CameraQuantity::rotation:
      return !is_rig_frame(camera);
    case CameraQuantity::k1:
      return lens_kind(camera.model.parameters().distortion).first_bend >= 0;
    case CameraQuantity::readout:
      return !camera.global_shutter.value_or(false);
    default:
      return true;
  }
}

/// The field of a quantity in sigmas of one kind or the other.
template <typename T>
T SigmasOf<T>::*field_of(CameraQuantity quantity) {
  switch (quantity) {
    case CameraQuantity::position:
      return &SigmasOf<T>::position_m;
    case CameraQuantity::rotation:
      return &SigmasOf<T>::rotation_rad;
    case CameraQuantity::focal:
      return &SigmasOf<T>::focal;
    case CameraQuantity::principal:
      return &SigmasOf<T>::principal_px;
    case CameraQuantity::k1:
      return &SigmasOf<T>::k1;
    case CameraQuantity::edge:
      return &SigmasOf<T>::edge_px;
    case CameraQuantity::stamp:
      return &SigmasOf<T>::stamp_s;
    case CameraQuantity::readout:
      break;
  }
  return &SigmasOf<T>::readout_s;
}

constexpr std::array kQuantities{CameraQuantity::position, CameraQuantity::rotation,
                                 CameraQuantity::focal,    CameraQuantity::principal,
                                 CameraQuantity::k1,       CameraQuantity::edge,
                                 CameraQuantity::stamp,    CameraQuantity::readout};

std::optional<double> readout_s(const RigCamera& camera) {
  if (camera.global_shutter.value_or(false)) return 0.0;
  if (!camera.readout_us) return std::nullopt;
  return 1e-6 * *camera.readout_us;
}

SigmaSource source_of(const RigCamera& camera) {
  return camera.sigma_source.value_or(SigmaSource::kalibr);
}

}  // namespace

bool is_rig_frame(const RigCamera& camera) {
  const Rigid3& place = camera.rig_from_cam;
  return place.translation.isZero(0) && place.rotation.vec().isZero(0);
}

std::vector<RigParameter> rig_parameters(const Rig& rig) {
  std::vector<RigParameter> parameters;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    for (const CameraQuantity quantity : kQuantities) {
      if (!has(rig.cameras[c], quantity)) continue;
      for (int axis = 0; axis < axes_of(quantity); ++axis) {
        parameters.push_back({c, quantity, axis});
      }
    }
  }
  return parameters;
}

CameraSigmas sigmas_of(const RigCamera& camera, const SigmaCircumstances& circumstances) {
  CameraSigmas sigmas = default_sigmas(source_of(camera), readout_s(camera), circumstances);
  for (const CameraQuantity quantity : kQuantities) {
    double& sigma = sigmas.*field_of<double>(quantity);
    const auto& stated = camera.stated_sigmas.*field_of<std::optional<double>>(quantity);
    sigma = has(camera, quantity) ? stated.value_or(sigma) : 0.0;
  }
  return sigmas;
}

double sigma_of(const RigParameter& parameter, const CameraSigmas& sigmas) {
  return sigmas.*field_of<double>(parameter.quantity);
}

Eigen::MatrixXd rig_covariance(const Rig& rig, const SigmaCircumstances& circumstances) {
  if (rig.joint_sigmas) return *rig.joint_sigmas;
  const std::vector<RigParameter> parameters = rig_parameters(rig);
  const auto count = static_cast<Eigen::Index>(parameters.size());
  Eigen::VectorXd sigmas(count);
  Eigen::VectorXd edges = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const RigParameter& one = parameters[static_cast<std::size_t>(i)];
    sigmas[i] = sigma_of(one, sigmas_of(rig.cameras[one.camera], circumstances));
    if (one.quantity == CameraQuantity::edge) edges[i] = sigmas[i];
  }
  Eigen::MatrixXd covariance = kCommonShare * edges * edges.transpose();
  covariance.diagonal() = sigmas.cwiseAbs2();
  return covariance;
}

void state_sigma(std::size_t camera, CameraQuantity quantity, double sigma, Rig& rig) {
  RigCamera& one = rig.cameras[camera];
  one.stated_sigmas.*field_of<std::optional<double>>(quantity) = sigma;
  if (!rig.joint_sigmas) return;
  const std::vector<RigParameter> parameters = rig_parameters(rig);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].camera != camera || parameters[i].quantity != quantity) continue;
    const auto at = static_cast<Eigen::Index>(i);
    rig.joint_sigmas->row(at).setZero();
    rig.joint_sigmas->col(at).setZero();
    (*rig.joint_sigmas)(at, at) = sigma * sigma;
  }
}

void drop_unfit_joint_sigmas(Rig& rig) {
  const auto count = static_cast<Eigen::Index>(rig_parameters(rig).size());
  if (rig.joint_sigmas && rig.joint_sigmas->rows() != count) rig.joint_sigmas.reset();
}

Rig single_camera_rig(const Rig& rig, std::size_t camera) {
  Rig single;
  single.cameras.push_back(rig.cameras[camera]);
  single.cameras.front().rig_from_cam = Rigid3{};
  single.cameras.front().stated_sigmas.position_m.reset();
  single.cameras.front().stated_sigmas.rotation_rad.reset();
  if (!rig.joint_sigmas) return single;
  const std::vector<RigParameter> parameters = rig_parameters(rig);
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const RigParameter& one = parameters[i];
    const bool of_place =
        one.quantity == CameraQuantity::position || one.quantity == CameraQuantity::rotation;
    if (one.camera == camera && !of_place) kept.push_back(static_cast<Eigen::Index>(i));
  }
  single.joint_sigmas = (*rig.joint_sigmas)(kept, kept);
  return single;
}

Rig stated_exact(Rig rig) {
  constexpr double kExact = 1e-9;
  rig.joint_sigmas.reset();
  for (RigCamera& camera : rig.cameras) {
    camera.stated_sigmas = {};
    for (const CameraQuantity quantity : kQuantities) {
      if (has(camera, quantity))
        camera.stated_sigmas.*field_of<std::optional<double>>(quantity) = kExact;
    }
  }
  return rig;
}

std::optional<std::string> note_of_default_sigmas(const Rig& rig, const std::string& name) {
  const auto states = [](const RigCamera& camera) {
    return camera.stated_sigmas != StatedSigmas{};
  };
  if (rig.joint_sigmas || rig.cameras.empty() ||
      std::any_of(rig.cameras.begin(), rig.cameras.end(), states)) {
    return std::nullopt;
  }
  const SigmaSource source = source_of(rig.cameras.front());
  const CameraSigmas sigmas = default_sigmas(source, std::nullopt, {});
  const std::string places =
      rig.cameras.size() < 2
          ? ""
          : fmt::format("{:g} mm and {:.3g}° between cameras, ", 1e3 * sigmas.position_m,
                        kDegPerRad * sigmas.rotation_rad);
  return fmt::format(
      "{}: states no sigma; those of calibrations of source {} are taken: {}focal length {:g} %, "
      "principal point {:g} px, k1 {:g}, edges {:g} px",
      name, to_string(source), places, 100 * sigmas.focal, sigmas.principal_px, sigmas.k1,
      sigmas.edge_px);
}

}  // namespace waymark
