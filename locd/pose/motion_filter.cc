#include "locd/pose/motion_filter.h"

#include <algorithm>
#include <chrono>

#include "core/base/check.h"
#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

double seconds_between(Stamp from, Stamp to) { return in_s(to - from); }

Matrix6d diagonal(double translation, double rotation) {
  Vector6d d;
  d << Eigen::Vector3d::Constant(translation), Eigen::Vector3d::Constant(rotation);
  return d.asDiagonal();
}

}  // namespace

Status MotionOptions::check() const {
  return RangeCheck()
      .field("max_age_s", max_age_s, kMaxAge_s)
      .field("speed_sigma_mps", speed_sigma_mps, {0.05, 20})
      .field("turn_sigma_radps", turn_sigma_radps, {0.05, 20})
      .field("accel_density", accel_density, {0.01, 100})
      .field("turn_accel_density", turn_accel_density, {0.01, 100})
      .status();
}

MotionFilter::MotionFilter(const MotionOptions& options) : options_(options) {
  WAYMARK_CHECK(options.check().has_value());
}

Matrix6d MotionFilter::unknown_velocity_covariance() const {
  return diagonal(options_.speed_sigma_mps * options_.speed_sigma_mps,
                  options_.turn_sigma_radps * options_.turn_sigma_radps);
}

MotionFilter::State MotionFilter::propagate(double seconds) const {
  State next;
  next.velocity = state_.velocity;
  next.pose = state_.pose.plus(state_.velocity * seconds);
  const Matrix6d pp = state_.covariance.topLeftCorner<6, 6>();
  const Matrix6d pv = state_.covariance.topRightCorner<6, 6>();
  const Matrix6d vv = state_.covariance.bottomRightCorner<6, 6>();
  const Matrix6d density = diagonal(options_.accel_density * options_.accel_density,
                                    options_.turn_accel_density * options_.turn_accel_density);
  const double t = seconds;
  const Matrix6d cross = pv + t * vv + t * t / 2 * density;
  next.covariance.topLeftCorner<6, 6>() =
      pp + t * (pv + pv.transpose()) + t * t * vv + t * t * t / 3 * density;
  next.covariance.topRightCorner<6, 6>() = cross;
  next.covariance.bottomLeftCorner<6, 6>() = cross.transpose();
  next.covariance.bottomRightCorner<6, 6>() = vv + t * density;
  return next;
}

std::optional<MotionPrediction> MotionFilter::predict(Stamp stamp) const {
  if (updates_ == 0) return std::nullopt;
  const double age_s = seconds_between(stamp_, stamp);
  if (age_s < 0 || age_s > options_.max_age_s) return std::nullopt;
  const State state = propagate(age_s);
  MotionPrediction prediction;
  prediction.world_from_rig = state.pose;
  prediction.covariance = state.covariance.topLeftCorner<6, 6>();
  prediction.velocity = state.velocity;
  prediction.velocity_covariance = state.covariance.bottomRightCorner<6, 6>();
  prediction.velocity_known = updates_ >= 2;
  return prediction;
}

void MotionFilter::update(Stamp stamp, const MotionEvidence& evidence) {
  constexpr double kAnywhere = 1e8;
  const double age_s = seconds_between(stamp_, stamp);
  const bool anew = updates_ == 0 || age_s <= 0 || age_s > options_.max_age_s;
  State state;
  if (anew) {
    state.pose = evidence.world_from_rig;
    state.velocity.setZero();
    state.covariance.setZero();
    state.covariance.topLeftCorner<6, 6>().diagonal().setConstant(kAnywhere);
    state.covariance.bottomRightCorner<6, 6>() = unknown_velocity_covariance();
  } else {
    state = propagate(age_s);
  }
  Matrix12d information;
  information << evidence.of_pose, evidence.of_both, evidence.of_both.transpose(),
      evidence.of_velocity;
  Eigen::Matrix<double, 12, 1> from_state;
  from_state << evidence.world_from_rig.minus(state.pose), evidence.velocity - state.velocity;
  Eigen::Matrix<double, 12, 1> pull = information * from_state;
  pull.head<6>() += evidence.towards_pose;
  pull.tail<6>() += evidence.towards_velocity;
  const Matrix12d posterior = SymmetricFactor<12>(state.covariance).inverse() + information;
  const SymmetricFactor<12> factor(posterior);
  const Eigen::Matrix<double, 12, 1> step = factor.solve(pull);
  state_.pose = state.pose.plus(step.head<6>());
  state_.velocity = state.velocity + step.tail<6>();
  state_.covariance = factor.inverse();
  state_.covariance = (0.5 * (state_.covariance + state_.covariance.transpose())).eval();
  updates_ = anew ? 1 : std::min(updates_ + 1, 1000);
  stamp_ = stamp;
}

}  // namespace waymark
