#include "core/estimate/consider_pose.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

/// Pose, then velocity.
constexpr Eigen::Index kMotion = 12;
/// Nothing is known better than this (usual sigmas, squared): exact calibrations stay invertible.
constexpr double kLeastVariance = 1e-10;

/// What a careful calibration is known to: the units of all numbers.
CalibrationVector usual_sigmas() {
  constexpr double kRadPerDeg = std::numbers::pi / 180.0;
  CalibrationVector v;
  v << Eigen::Vector3d::Constant(1e-3), Eigen::Vector3d::Constant(0.05 * kRadPerDeg), 1e-3, 0.5,
      0.5, 5e-3, 0.02, 1e-3, 1e-3;
  return v;
}

bool is_rig_frame(const RigCamera& camera) {
  return camera.rig_from_cam.translation.isZero() && camera.rig_from_cam.rotation.vec().isZero();
}

double readout_sigma_s(const RigCamera& camera, const CalibrationSigmas& sigmas) {
  constexpr double kStatedShare = 0.02;
  if (camera.global_shutter.value_or(false)) return 0;
  if (!camera.readout_us) return sigmas.readout_s;
  return std::min(sigmas.readout_s, kStatedShare * 1e-6 * *camera.readout_us);
}

}  // namespace

const CalibrationVector& CalibrationPrior::units() {
  static const CalibrationVector kUnits = usual_sigmas();
  return kUnits;
}

CalibrationPrior::CalibrationPrior(const Rig& rig, const CalibrationSigmas& sigmas,
                                   double size_share)
    : cameras_(rig.cameras.size()) {
  const Eigen::Index size = first_of(cameras_) + 1;
  covariance_.setZero(size, size);
  for (std::size_t c = 0; c < cameras_; ++c) {
    CalibrationVector own;
    own << Eigen::Vector3d::Constant(sigmas.position_m),
        Eigen::Vector3d::Constant(sigmas.rotation_rad), sigmas.focal, sigmas.principal_px,
        sigmas.principal_px, sigmas.k1, sigmas.edge_px, sigmas.stamp_s,
        readout_sigma_s(rig.cameras[c], sigmas);
    if (is_rig_frame(rig.cameras[c])) own.head<6>().setZero();
    widen(c, own);
  }
  covariance_(size - 1, size - 1) = std::pow(size_share / kSizeUnit, 2);
  covariance_.diagonal().array() += kLeastVariance;
}

void CalibrationPrior::widen(std::size_t camera, const CalibrationVector& sigmas) {
  covariance_.diagonal().segment<kCalibrationNumbers>(first_of(camera)).array() +=
      (sigmas.array() / units().array()).square();
}

CalibrationVector CalibrationPrior::variances_of(std::size_t camera) const {
  return covariance_.diagonal()
      .segment<kCalibrationNumbers>(first_of(camera))
      .cwiseProduct(units().cwiseAbs2());
}

double CalibrationPrior::size_variance() const {
  return covariance_(size() - 1, size() - 1) * kSizeUnit * kSizeUnit;
}

ConsiderPose::ConsiderPose(std::size_t cameras) : slot_(cameras, -1) {
  const Eigen::Index most = kMotion + CalibrationPrior::first_of(cameras) + 1;
  hessian_.setZero(most, most);
  inverse_.setZero(most, most);
  prior_.setZero(most, most);
  right_.setZero(most);
  x_.setZero(most);
}

ConsiderPose::Columns ConsiderPose::columns_of(const ConsideredObservation& observation) const {
  Columns columns;
  columns << observation.columns.by_pose, observation.columns.by_velocity,
      observation.columns.by_camera * CalibrationPrior::units().asDiagonal(),
      observation.columns.by_size * CalibrationPrior::kSizeUnit;
  return columns;
}

void ConsiderPose::add(const ConsideredObservation& observation) {
  const Columns j = columns_of(observation);
  const Eigen::Index camera = slot_of(observation.camera);
  const Eigen::Index size = size_ - 1;
  Eigen::Matrix<double, Columns::ColsAtCompileTime, Columns::ColsAtCompileTime> square;
  square.noalias() = j.transpose() * j;
  const Eigen::Matrix<double, Columns::ColsAtCompileTime, 1> pull =
      j.transpose() * observation.columns.residual;
  constexpr Eigen::Index kLast = kMotion + kCalibrationNumbers;
  // The lower triangle alone.
  hessian_.block<kMotion, kMotion>(0, 0) += square.topLeftCorner<kMotion, kMotion>();
  hessian_.block<kCalibrationNumbers, kMotion>(camera, 0) +=
      square.block<kCalibrationNumbers, kMotion>(kMotion, 0);
  hessian_.block<kCalibrationNumbers, kCalibrationNumbers>(camera, camera) +=
      square.block<kCalibrationNumbers, kCalibrationNumbers>(kMotion, kMotion);
  hessian_.block<1, kMotion>(size, 0) += square.block<1, kMotion>(kLast, 0);
  hessian_.block<1, kCalibrationNumbers>(size, camera) +=
      square.block<1, kCalibrationNumbers>(kLast, kMotion);
  hessian_(size, size) += square(kLast, kLast);
  right_.head<kMotion>() += pull.head<kMotion>();
  right_.segment<kCalibrationNumbers>(camera) += pull.segment<kCalibrationNumbers>(kMotion);
  right_[size] += pull[kLast];
}

bool ConsiderPose::solve(std::span<const ConsideredObservation> observations,
                         const CalibrationPrior& prior, const Matrix6d& velocity_covariance) {
  std::fill(slot_.begin(), slot_.end(), -1);
  for (const ConsideredObservation& o : observations) slot_[o.camera] = 0;
  size_ = kMotion;
  for (Eigen::Index& slot : slot_) {
    if (slot < 0) continue;
    slot = size_;
    size_ += kCalibrationNumbers;
  }
  ++size_;
  // The prior of the cameras that see something, and of the size.
  auto known = prior_.topLeftCorner(size_ - kMotion, size_ - kMotion);
  const Eigen::Index last = size_ - kMotion - 1;
  const Eigen::Index prior_last = prior.size() - 1;
  for (std::size_t a = 0; a < slot_.size(); ++a) {
    if (slot_[a] < 0) continue;
    for (std::size_t b = 0; b < slot_.size(); ++b) {
      if (slot_[b] < 0) continue;
      known.block<kCalibrationNumbers, kCalibrationNumbers>(slot_[a] - kMotion,
                                                            slot_[b] - kMotion) =
          prior.covariance().block<kCalibrationNumbers, kCalibrationNumbers>(
              CalibrationPrior::first_of(a), CalibrationPrior::first_of(b));
    }
    known.block<1, kCalibrationNumbers>(last, slot_[a] - kMotion) =
        prior.covariance().block<1, kCalibrationNumbers>(prior_last, CalibrationPrior::first_of(a));
  }
  known(last, last) = prior.covariance()(prior_last, prior_last);

  auto h = hessian_.topLeftCorner(size_, size_);
  auto inverse = inverse_.topLeftCorner(size_, size_);
  h.setZero();
  right_.head(size_).setZero();
  {
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(known);
    auto of_calibration = h.bottomRightCorner(size_ - kMotion, size_ - kMotion);
    of_calibration.setIdentity();
    factor.matrixL().solveInPlace(of_calibration);
    factor.matrixU().solveInPlace(of_calibration);
  }
  h.block<6, 6>(6, 6) = SymmetricFactor<6>(velocity_covariance).inverse();
  misfit_ = 0;
  freedoms_ = -6;
  for (const ConsideredObservation& o : observations) {
    if (!o.used) continue;
    add(o);
    misfit_ += o.columns.residual.squaredNorm();
    freedoms_ += 8;
  }
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(h);
  if (factor.info() != Eigen::Success) return false;
  auto x = x_.head(size_);
  x = right_.head(size_);
  factor.matrixL().solveInPlace(x);
  misfit_ -= x.squaredNorm();
  factor.matrixU().solveInPlace(x);
  inverse.setIdentity();
  factor.matrixL().solveInPlace(inverse);
  factor.matrixU().solveInPlace(inverse);
  return x.allFinite() && inverse.allFinite();
}

ConsiderPose::Touched ConsiderPose::touched_by(std::size_t camera) const {
  struct Part {
    Eigen::Index to, from, count;
  };
  const std::array<Part, 3> parts{{{0, 0, kMotion},
                                   {kMotion, slot_[camera], kCalibrationNumbers},
                                   {kMotion + kCalibrationNumbers, size_ - 1, 1}}};
  Touched touched;
  for (const Part& a : parts) {
    touched.value.segment(a.to, a.count) = x_.segment(a.from, a.count);
    for (const Part& b : parts) {
      touched.covariance.block(a.to, b.to, a.count, b.count) =
          inverse_.block(a.from, b.from, a.count, b.count);
    }
  }
  return touched;
}

Eigen::Matrix<double, 6, 8> ConsiderPose::gain(const ConsideredObservation& observation) const {
  return touched_by(observation.camera).covariance.topRows<6>() *
         columns_of(observation).transpose();
}

double ConsiderPose::squared_sigmas(const ConsideredObservation& observation) const {
  const Columns j = columns_of(observation);
  const Touched touched = touched_by(observation.camera);
  const Vector8d left = observation.columns.residual - j * touched.value;
  const Matrix8d of_pose = j * touched.covariance * j.transpose();
  // Leave-one-out of what carries the pose; the plain sum of what does not.
  const double sign = observation.used ? -1 : 1;
  const Matrix8d covariance = Matrix8d::Identity() + sign * of_pose;
  return left.dot(SymmetricFactor<8>(covariance).solve(left));
}

}  // namespace waymark
