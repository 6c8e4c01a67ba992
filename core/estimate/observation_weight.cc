#include "core/estimate/observation_weight.h"

#include <algorithm>
#include <cmath>

namespace waymark {

Status ObservationWeightOptions::check() const {
  return RangeCheck()
      .field("lambda_distance", lambda_distance, kLambda)
      .field("lambda_angle", lambda_angle, kLambda)
      .field("lambda_ambiguity", lambda_ambiguity, kLambda)
      .field("epsilon_rad", epsilon_rad, kDivisor)
      .field("max_distance_m", max_distance_m, kDivisor)
      .field("max_angle_rad", max_angle_rad, kDivisor)
      .status();
}

double observation_weight(double distance_m, double angle_rad, double rotation_difference_rad,
                          const ObservationWeightOptions& options) {
  const double d = distance_m / options.max_distance_m;
  const double a = angle_rad / options.max_angle_rad;
  const double r = rotation_difference_rad / options.epsilon_rad;
  // Equation (7).
  return std::exp(-options.lambda_distance * d * d - options.lambda_angle * a * a +
                  options.lambda_ambiguity * std::exp(-0.5 * r * r));
}

double observation_weight(const IppeSolutions& solutions, const ObservationWeightOptions& options) {
  const Rigid3& best = solutions.cam_from_marker[0];
  const double distance_m = best.translation.norm();
  const Eigen::Vector3d normal = best.rotation * Eigen::Vector3d::UnitZ();
  const double cosine = normal.dot(-best.translation) / std::max(distance_m, 1e-12);
  return observation_weight(distance_m, std::acos(std::clamp(cosine, -1.0, 1.0)),
                            angle_between_rad(best.rotation, solutions.cam_from_marker[1].rotation),
                            options);
}

}  // namespace waymark
