#include "locd/pose/pose_gate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/check.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

double largest_sigma(const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  return std::sqrt(std::max(0.0, symmetric_eigenvalues<3>(covariance).maxCoeff()));
}

}  // namespace

Status GateOptions::check() const {
  // As a configuration's degrees are converted, so that both ends are within.
  const auto radians = [](const Range& degrees) {
    constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
    return Range{degrees.low * kRadiansPerDegree, degrees.high * kRadiansPerDegree};
  };
  return RangeCheck()
      .field("max_3sigma_m", max_3sigma_m, kMax3Sigma_m)
      .field("max_3sigma_rad", max_3sigma_rad, radians(kMax3Sigma_deg))
      .field("max_protection_m", max_protection_m, kMaxProtection_m)
      .field("max_protection_rad", max_protection_rad, radians(kMaxProtection_deg))
      .field("v_max_mps", v_max_mps, kVMax_mps)
      .field("w_max_radps", w_max_radps, radians(kWMax_degps))
      .field("vouching_factor", vouching_factor, kVouchingFactor)
      .field("sets_to_believe_jump", sets_to_believe_jump, kSetsToBelieveJump)
      .status();
}

PoseGate::PoseGate(const GateOptions& options) : options_(options) {
  WAYMARK_CHECK(options.check().has_value());
}

PoseSigmas worst_sigmas(const Matrix6d& covariance) {
  return {largest_sigma(covariance.topLeftCorner<3, 3>()),
          largest_sigma(covariance.bottomRightCorner<3, 3>())};
}

bool agrees(const Vector6d& delta, const Matrix6d& covariance) {
  constexpr double kChi6At999 = 22.46;
  return delta.dot(SymmetricFactor<6>(covariance).solve(delta)) <= kChi6At999;
}

ReasonBits PoseGate::judge(Stamp stamp, const PoseSolution& solution,
                           const std::optional<MotionPrediction>& prior) {
  ReasonBits reasons = 0;
  const PoseSigmas sigmas = worst_sigmas(solution.covariance);
  // Written so that a NaN is a reason.
  if (!(3 * sigmas.position_m <= options_.max_3sigma_m &&
        3 * sigmas.rotation_rad <= options_.max_3sigma_rad)) {
    reasons |= bit(PoseReason::sigma);
  }
  if (solution.ambiguous || solution.rivals) reasons |= bit(PoseReason::ambiguous);
  bool vouched = false;
  if (prior) {
    const PoseSigmas expected = worst_sigmas(prior->covariance);
    vouched = 3 * expected.position_m <= options_.vouching_factor * options_.max_3sigma_m &&
              3 * expected.rotation_rad <= options_.vouching_factor * options_.max_3sigma_rad &&
              agrees(solution.world_from_rig.minus(prior->world_from_rig),
                     solution.covariance + prior->covariance);
  }
  if (solution.inlier_markers < 2 && !vouched) reasons |= bit(PoseReason::few_markers);
  // No prior vouches for a minority: it came of the same map.
  if (solution.outlier_markers >= solution.inlier_markers) {
    reasons |= bit(PoseReason::outliers);
  }
  // A pose that another one equals tells nothing of where the rig is.
  if (!solution.ambiguous && jumped({stamp, solution.world_from_rig, sigmas})) {
    reasons |= bit(PoseReason::jump);
  }
  return reasons;
}

ReasonBits PoseGate::judge(const Protection& protection) const {
  const auto within = [](double level, double limit) { return limit == 0 || level <= limit; };
  const bool fine = within(protection.horizontal_m, options_.max_protection_m) &&
                    within(protection.rotation_rad, options_.max_protection_rad);
  return fine ? 0 : bit(PoseReason::protection);
}

bool PoseGate::reachable(const Place& from, const Place& to) const {
  const double seconds = std::abs(in_s(to.stamp - from.stamp));
  const double moved_m = (to.pose.translation - from.pose.translation).norm();
  const double turned_rad = angle_between_rad(to.pose.rotation, from.pose.rotation);
  return moved_m <=
             options_.v_max_mps * seconds + 3 * (from.sigmas.position_m + to.sigmas.position_m) &&
         turned_rad <= options_.w_max_radps * seconds +
                           3 * (from.sigmas.rotation_rad + to.sigmas.rotation_rad);
}

PoseGate::Place PoseGate::expected(const Place& here) const {
  if (!elsewhere_) return *place_;
  return {elsewhere_->stamp, place_from_elsewhere_ * elsewhere_->pose, here.sigmas};
}

void PoseGate::settle(const Place& here, bool anew) {
  if (anew && known_) ++resets_;
  known_ = true;
  place_ = here;
  elsewhere_.reset();
}

bool PoseGate::jumped(const Place& here) {
  if (!place_ || reachable(expected(here), here)) {
    settle(here, !place_);
    return false;
  }
  if (elsewhere_ && reachable(*elsewhere_, here)) {
    ++sets_elsewhere_;
  } else {
    place_from_elsewhere_ = expected(here).pose * here.pose.inverse();
    sets_elsewhere_ = 1;
  }
  elsewhere_ = here;
  if (sets_elsewhere_ < options_.sets_to_believe_jump) return true;
  settle(here, true);
  return false;
}

}  // namespace waymark
