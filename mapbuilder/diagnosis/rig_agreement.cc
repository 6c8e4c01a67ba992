#include "mapbuilder/diagnosis/rig_agreement.h"

#include <cmath>

#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

constexpr double kBound = 36.0;  // 6 sigmas: 99.9997 % of χ² with six freedoms stay below

struct Term {
  const TrackedPlace* place = nullptr;
  const Rigid3* rig_from_cam = nullptr;
};

double cost_of(std::span<const Term> terms, const Rigid3& world_from_rig, double noise_scale) {
  double cost = 0;
  for (const Term& term : terms) {
    cost += bounded_misfit(
        squared_misfit(*term.place, world_from_rig * *term.rig_from_cam, noise_scale));
  }
  return cost;
}

/// One reweighted Gauss–Newton step.
Rigid3 step(std::span<const Term> terms, const Rigid3& world_from_rig, double noise_scale) {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  for (const Term& term : terms) {
    const Rigid3 predicted = world_from_rig * *term.rig_from_cam;
    const Vector6d misfit = term.place->world_from_cam.minus(predicted);
    // Of the prediction by the rig's tangent: the lever arm turns with the rig.
    Matrix6d jacobian = Matrix6d::Identity();
    jacobian.topRightCorner<3, 3>() = -skew(predicted.translation - world_from_rig.translation);
    const double weight = std::exp(-squared_misfit(*term.place, predicted, noise_scale) / kBound);
    const Matrix6d weighted = weight * jacobian.transpose() * term.place->information;
    hessian += weighted * jacobian;
    gradient += weighted * misfit;
  }
  const Vector6d delta = SymmetricFactor<6>(hessian).solve(gradient);
  return delta.allFinite() ? world_from_rig.plus(delta) : world_from_rig;
}

}  // namespace

double bounded_misfit(double squared_sigmas) {
  return kBound * -std::expm1(-squared_sigmas / kBound);
}

double squared_misfit(const TrackedPlace& place, const Rigid3& world_from_cam, double noise_scale) {
  const Vector6d misfit = place.world_from_cam.minus(world_from_cam);
  return misfit.dot(place.information * misfit) / (noise_scale * noise_scale);
}

InstantAgreement agree(const CameraTracks::Instant& instant, const Extrinsics& rig_from_cam,
                       double noise_scale, int without) {
  std::vector<Term> terms;
  for (std::size_t k = 0; k < instant.places.size(); ++k) {
    if (!instant.places[k] || static_cast<int>(k) == without) continue;
    terms.push_back({&*instant.places[k], &rig_from_cam[k]});
  }
  InstantAgreement agreement;
  agreement.cameras = static_cast<int>(terms.size());
  for (const Term& term : terms) {
    const Rigid3 start = term.place->world_from_cam * term.rig_from_cam->inverse();
    const double cost = cost_of(terms, start, noise_scale);
    if (agreement.world_from_rig && cost >= agreement.cost) continue;
    agreement.world_from_rig = start;
    agreement.cost = cost;
  }
  if (terms.size() < 2) return agreement;
  constexpr int kSteps = 4;
  for (int i = 0; i < kSteps; ++i) {
    const Rigid3 next = step(terms, *agreement.world_from_rig, noise_scale);
    const double cost = cost_of(terms, next, noise_scale);
    if (cost >= agreement.cost) break;
    agreement.world_from_rig = next;
    agreement.cost = cost;
  }
  return agreement;
}

}  // namespace waymark
