#include "mapbuilder/upkeep/marker_prior.h"

#include "core/geometry/decompositions.h"
#include "mapbuilder/bundle/bundle_variables.h"

namespace waymark {
namespace {

constexpr double kLeastSigma = 1e-5;   // m and rad
constexpr double kUnknownSigma = 0.1;  // m and rad

Matrix6d whitening_of(const Matrix6d& covariance) {
  if (!covariance.allFinite()) return Matrix6d::Identity() / kUnknownSigma;
  const SymmetricEigen<6> eigen = symmetric_eigen<6>(covariance);
  const Vector6d sigmas = eigen.values.cwiseMax(kLeastSigma * kLeastSigma).cwiseSqrt();
  return sigmas.cwiseInverse().asDiagonal() * eigen.vectors.transpose();
}

}  // namespace

MarkerPrior::MarkerPrior(int block, const Rigid3& world_from_marker, const Matrix6d& covariance)
    : block_(block), world_from_marker_(world_from_marker), whitening_(whitening_of(covariance)) {}

FactorLinearization MarkerPrior::linearize(const BundleVariables& at) const {
  FactorLinearization result;
  const Rigid3& pose = at.world_from_marker[static_cast<std::size_t>(block_)];
  result.residual = whitening_ * pose.minus(world_from_marker_);
  // d Log(Exp(δφ) R R₀ᵀ) / dδφ is 1 to first order of the turn since, 2° at most.
  result.parts.push_back({block_, whitening_});
  return result;
}

}  // namespace waymark
