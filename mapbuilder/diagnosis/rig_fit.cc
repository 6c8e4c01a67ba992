#include "mapbuilder/diagnosis/rig_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

/// How well a rig file is known that is right, one standard deviation per axis of rig_from_cam:
/// twice what a calibration with a target leaves (1 mm, 0.05°). A hypothesis need not explain less.
constexpr double kPositionSigma_m = 0.002;
constexpr double kRotationSigma_rad = 0.001745;

/// Instants that rigs are compared on; of more, every n-th.
constexpr std::size_t kMaxInstants = 160;

/// Where a camera stood, and where the others put the rig then.
struct Sight {
  const TrackedPlace* place;
  Rigid3 world_from_rig;
};

}  // namespace

RigFit::RigFit(const CameraTracks& tracks, const Extrinsics& stated) : stated_(stated) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kPositionSigma_m),
      Eigen::Vector3d::Constant(kRotationSigma_rad);
  prior_ = sigma.cwiseAbs2().cwiseInverse();
  std::vector<std::size_t> shared;
  for (std::size_t i = 0; i < tracks.instants.size(); ++i) {
    const auto& places = tracks.instants[i].places;
    const auto seen =
        std::count_if(places.begin(), places.end(), [](const auto& p) { return p.has_value(); });
    if (seen >= 2) shared.push_back(i);
  }
  const std::size_t every = 1 + shared.size() / (kMaxInstants + 1);
  for (std::size_t i = 0; i < shared.size(); i += every) judged_.push_back(shared[i]);
}

double RigFit::cost(const CameraTracks& tracks, const Extrinsics& rig, InstantRange range) const {
  double cost = 0;
  for (std::size_t j = range.first; j < range.last; ++j) {
    cost += agree(tracks.instants[judged_[j]], rig, noise_scale_).cost;
  }
  return cost;
}

std::vector<double> RigFit::costs(const CameraTracks& tracks, const Extrinsics& rig) const {
  std::vector<double> costs;
  for (const std::size_t i : judged_) {
    costs.push_back(agree(tracks.instants[i], rig, noise_scale_).cost);
  }
  return costs;
}

double RigFit::prior_cost(const Extrinsics& rig, const Extrinsics& start, FreeCameras free) const {
  double cost = 0;
  for (std::size_t k = 0; k < cameras(); ++k) {
    if (free.holds(k)) continue;
    const Vector6d off = rig[k].minus(start[k]);
    cost += off.dot(prior_.cwiseProduct(off));
  }
  return cost;
}

double RigFit::stated_sigmas(const Rigid3& place, const Rigid3& from) const {
  const Vector6d off = place.minus(from);
  return std::sqrt(off.dot(prior_.cwiseProduct(off)));
}

Extrinsics RigFit::fit(const CameraTracks& tracks, const Extrinsics& start, FreeCameras free,
                       InstantRange range) const {
  constexpr int kRounds = 6;
  Extrinsics rig = start;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Matrix6d> hessian(cameras(), Matrix6d::Zero());
    std::vector<Vector6d> gradient(cameras(), Vector6d::Zero());
    for (std::size_t j = range.first; j < range.last; ++j) {
      const CameraTracks::Instant& instant = tracks.instants[judged_[j]];
      const InstantAgreement agreement = agree(instant, rig, noise_scale_);
      if (agreement.cameras < 2) continue;
      for (std::size_t k = 0; k < cameras(); ++k) {
        if (!instant.places[k]) continue;
        add_place(*instant.places[k], *agreement.world_from_rig, rig[k], hessian[k], gradient[k]);
      }
    }
    for (std::size_t k = 0; k < cameras(); ++k) {
      if (free.holds(k)) {
        hessian[k].diagonal() += 1e-6 * prior_;
      } else {
        hessian[k].diagonal() += prior_;
        gradient[k] -= prior_.cwiseProduct(rig[k].minus(start[k]));
      }
      const Vector6d delta = SymmetricFactor<6>(hessian[k]).solve(gradient[k]);
      if (delta.allFinite()) rig[k] = rig[k].plus(delta);
    }
  }
  return rig;
}

void RigFit::add_place(const TrackedPlace& place, const Rigid3& world_from_rig,
                       const Rigid3& rig_from_cam, Matrix6d& hessian, Vector6d& gradient) const {
  const Rigid3 predicted = world_from_rig * rig_from_cam;
  const double squared = squared_misfit(place, predicted, noise_scale_);
  const double weight = std::exp(-squared / 36.0) / (noise_scale_ * noise_scale_);
  const Matrix6d turn = left_motion_jacobian(world_from_rig);
  const Matrix6d weighted = weight * turn.transpose() * place.information;
  hessian += weighted * turn;
  gradient += weighted * place.world_from_cam.minus(predicted);
}

std::optional<Rigid3> RigFit::place_by_others(const CameraTracks& tracks, std::size_t camera,
                                              InstantRange range) const {
  std::vector<Sight> sights;
  for (std::size_t j = range.first; j < range.last; ++j) {
    const CameraTracks::Instant& instant = tracks.instants[judged_[j]];
    const auto& place = instant.places[camera];
    if (!place) continue;
    const InstantAgreement others = agree(instant, stated_, noise_scale_, static_cast<int>(camera));
    if (others.world_from_rig) sights.push_back({&*place, *others.world_from_rig});
  }
  constexpr std::size_t kMaxCandidates = 60;
  const std::size_t every = 1 + sights.size() / (kMaxCandidates + 1);
  std::optional<Rigid3> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < sights.size(); i += every) {
    const Rigid3 candidate = sights[i].world_from_rig.inverse() * sights[i].place->world_from_cam;
    double cost = 0;
    for (const Sight& s : sights) {
      cost += bounded_misfit(
          squared_misfit(*s.place, s.world_from_rig * candidate, 2.0 * noise_scale_));
    }
    if (cost < least) {
      least = cost;
      best = candidate;
    }
  }
  return best;
}

}  // namespace waymark
