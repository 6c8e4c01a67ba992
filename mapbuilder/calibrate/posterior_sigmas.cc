#include "mapbuilder/calibrate/posterior_sigmas.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/camera/lens_kind.h"
#include "core/camera/rig_parameters.h"

namespace waymark {
namespace {

constexpr Eigen::Index kExtrinsics = 6;
constexpr Eigen::Index kIntrinsics = kIntrinsicNumbers;

/// The row of a parameter in terms of the joint covariance's numbers; empty (zero) for what no
/// adjustment calibrates.
Eigen::RowVectorXd row_of(const RigParameter& parameter, const Rig& rig) {
  const auto cameras = static_cast<Eigen::Index>(rig.cameras.size());
  const auto camera = static_cast<Eigen::Index>(parameter.camera);
  const Eigen::Index place = kExtrinsics * camera;
  const Eigen::Index lens = kExtrinsics * cameras + kIntrinsics * camera;
  const CameraParameters& p = rig.cameras[parameter.camera].model.parameters();
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero((kExtrinsics + kIntrinsics) * cameras);
  switch (parameter.quantity) {
    case CameraQuantity::position:
      row[place + parameter.axis] = 1;
      break;
    case CameraQuantity::rotation:
      row[place + 3 + parameter.axis] = 1;
      break;
    case CameraQuantity::focal:
      row[lens] = 0.5 / p.fu_px;
      row[lens + 1] = 0.5 / p.fv_px;
      break;
    case CameraQuantity::principal:
      row[lens + 2 + parameter.axis] = 1;
      break;
    case CameraQuantity::k1:
      row[lens + 4 + lens_kind(p.distortion).first_bend] = 1;
      break;
    default:
      break;
  }
  return row;
}

/// What a number is known to where some direction could not be told.
double limit_of(const RigParameter& parameter, const Rig& rig, const RefinementLimits& limits) {
  const CameraParameters& p = rig.cameras[parameter.camera].model.parameters();
  const double edge = 0.5 * std::hypot(p.width_px / p.fu_px, p.height_px / p.fv_px);
  switch (parameter.quantity) {
    case CameraQuantity::position:
      return limits.position_m;
    case CameraQuantity::rotation:
      return limits.rotation_rad;
    case CameraQuantity::focal:
      return limits.focal;
    case CameraQuantity::principal:
      return limits.rotation_rad * p.fu_px;
    case CameraQuantity::k1:
      return limits.rotation_rad / (edge * edge * edge);
    default:
      return 0;
  }
}

/// Whether an adjustment calibrates it.
bool is_calibrated(const RigParameter& parameter) {
  switch (parameter.quantity) {
    case CameraQuantity::edge:
    case CameraQuantity::stamp:
    case CameraQuantity::readout:
      return false;
    default:
      return true;
  }
}

/// How much larger a number is in one rig than in another.
double difference(const RigParameter& parameter, const Rig& one, const Rig& other) {
  const RigCamera& a = one.cameras[parameter.camera];
  const RigCamera& b = other.cameras[parameter.camera];
  const CameraParameters& p = a.model.parameters();
  const CameraParameters& q = b.model.parameters();
  switch (parameter.quantity) {
    case CameraQuantity::position:
      return a.rig_from_cam.minus(b.rig_from_cam)[parameter.axis];
    case CameraQuantity::rotation:
      return a.rig_from_cam.minus(b.rig_from_cam)[3 + parameter.axis];
    case CameraQuantity::focal:
      return 0.5 * ((p.fu_px - q.fu_px) / q.fu_px + (p.fv_px - q.fv_px) / q.fv_px);
    case CameraQuantity::principal:
      return parameter.axis == 0 ? p.pu_px - q.pu_px : p.pv_px - q.pv_px;
    case CameraQuantity::k1:
      return intrinsics_of(p)[4 + lens_kind(p.distortion).first_bend] -
             intrinsics_of(q)[4 + lens_kind(q.distortion).first_bend];
    default:
      return 0;
  }
}

/// States the largest of a quantity's axes.
void state(const RigParameter& parameter, double sigma, Rig& rig) {
  StatedSigmas& stated = rig.cameras[parameter.camera].stated_sigmas;
  const auto raise = [&](std::optional<double>& known) {
    known = std::max(known.value_or(0.0), sigma);
  };
  switch (parameter.quantity) {
    case CameraQuantity::position:
      return raise(stated.position_m);
    case CameraQuantity::rotation:
      return raise(stated.rotation_rad);
    case CameraQuantity::focal:
      return raise(stated.focal);
    case CameraQuantity::principal:
      return raise(stated.principal_px);
    case CameraQuantity::k1:
      return raise(stated.k1);
    default:
      return;
  }
}

/// Forgets what an earlier file stated of numbers that are calibrated now.
Rig without_stated(Rig rig) {
  rig.joint_sigmas.reset();
  for (RigCamera& camera : rig.cameras) {
    StatedSigmas kept;
    kept.edge_px = camera.stated_sigmas.edge_px;
    kept.stamp_s = camera.stated_sigmas.stamp_s;
    kept.readout_s = camera.stated_sigmas.readout_s;
    camera.stated_sigmas = kept;
  }
  return rig;
}

}  // namespace

Rig with_posterior_sigmas(Rig rig, const Eigen::MatrixXd& joint, bool held,
                          const RefinementLimits& limits) {
  const auto cameras = static_cast<Eigen::Index>(rig.cameras.size());
  WAYMARK_CHECK(joint.rows() == (kExtrinsics + kIntrinsics) * cameras);
  rig = without_stated(std::move(rig));
  const std::vector<RigParameter> parameters = rig_parameters(rig);
  const auto count = static_cast<Eigen::Index>(parameters.size());
  Eigen::MatrixXd by_number(count, joint.rows());
  for (Eigen::Index i = 0; i < count; ++i) {
    by_number.row(i) = row_of(parameters[static_cast<std::size_t>(i)], rig);
  }
  // What comes of nothing calibrated keeps its own covariance; with the rest it has none in common.
  const Eigen::MatrixXd known = rig_covariance(rig);
  Eigen::MatrixXd covariance = by_number * joint * by_number.transpose();
  std::vector<char> calibrated;
  for (Eigen::Index i = 0; i < count; ++i) calibrated.push_back(covariance(i, i) > 0 ? 1 : 0);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const bool neither = calibrated[static_cast<std::size_t>(i)] == 0 &&
                           calibrated[static_cast<std::size_t>(j)] == 0;
      if (neither) covariance(i, j) = known(i, j);
    }
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    const RigParameter& one = parameters[static_cast<std::size_t>(i)];
    if (held) covariance(i, i) += std::pow(limit_of(one, rig, limits), 2);
    if (calibrated[static_cast<std::size_t>(i)] != 0) {
      state(one, std::sqrt(covariance(i, i)), rig);
    }
  }
  for (RigCamera& camera : rig.cameras) camera.sigma_source = SigmaSource::refined;
  rig.joint_sigmas = 0.5 * (covariance + covariance.transpose());
  return rig;
}

double squared_sigmas_apart(const Rig& one, const Rig& other) {
  WAYMARK_CHECK(one.joint_sigmas && other.joint_sigmas);
  const std::vector<RigParameter> parameters = rig_parameters(one);
  WAYMARK_CHECK(one.joint_sigmas->rows() == other.joint_sigmas->rows());
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!is_calibrated(parameters[i])) continue;
    const auto at = static_cast<Eigen::Index>(i);
    const double variance = (*one.joint_sigmas)(at, at) + (*other.joint_sigmas)(at, at);
    sum += std::pow(difference(parameters[i], one, other), 2) / variance;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

Rig with_sigmas_times(Rig rig, double factor) {
  for (RigCamera& camera : rig.cameras) {
    StatedSigmas& stated = camera.stated_sigmas;
    for (auto* sigma : {&stated.position_m, &stated.rotation_rad, &stated.focal,
                        &stated.principal_px, &stated.k1}) {
      if (*sigma) **sigma *= factor;
    }
  }
  if (!rig.joint_sigmas) return rig;
  const std::vector<RigParameter> parameters = rig_parameters(rig);
  Eigen::VectorXd factors(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    factors[static_cast<Eigen::Index>(i)] = is_calibrated(parameters[i]) ? factor : 1.0;
  }
  rig.joint_sigmas = factors.asDiagonal() * *rig.joint_sigmas * factors.asDiagonal();
  return rig;
}

}  // namespace waymark
