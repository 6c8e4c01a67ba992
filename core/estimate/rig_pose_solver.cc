#include "core/estimate/rig_pose_solver.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace waymark {
namespace {

/// Equal scores stay in the order of their indices; std::stable_sort would allocate.
template <typename Candidates>
void sort_by_score(Candidates& candidates) {
  std::sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
    return a.score != b.score ? a.score < b.score : a.index < b.index;
  });
}

/// Equation (10)'s observation: the one whose own IPPE solution fits its own corners best; nullptr
/// when none has a solution.
const FixedMarkerObservation* best_own_fit(std::span<const FixedMarkerObservation> observations) {
  const FixedMarkerObservation* best = nullptr;
  for (const FixedMarkerObservation& fixed : observations) {
    const auto& ippe = fixed.observation->ippe;
    if (ippe && (best == nullptr || ippe->rms_px[0] < best->observation->ippe->rms_px[0])) {
      best = &fixed;
    }
  }
  return best;
}

}  // namespace

Status RigPoseOptions::check() const {
  constexpr Range kScoreScale{5, 100};
  return RangeCheck()
      .part("loss", loss.check())
      .field("score_scale_sigmas", score_scale_sigmas, kScoreScale)
      .field("bounded_score_sigmas", bounded_score_sigmas.value_or(kScoreScale.low), kScoreScale)
      .field("max_seed_observations", max_seed_observations, {1, 1000})
      .field("max_refined", max_refined, {2, 50})
      .field("max_iterations", max_iterations, {1, 200})
      .field("ambiguity_gap", ambiguity_gap, {0, 1000})
      .field("distinct_rad", distinct_rad, {0.002, 0.5})
      .field("distinct_m", distinct_m, {0.001, 1})
      .status();
}

RigPoseSolver::RigPoseSolver(const Rig& rig, const RigPoseOptions& options) : options_(options) {
  WAYMARK_CHECK(options.check().has_value());
  for (const RigCamera& camera : rig.cameras) {
    models_.push_back(&camera.model);
    cam_from_rig_.push_back(camera.rig_from_cam.inverse());
  }
}

void RigPoseSolver::reserve(std::size_t observations) {
  // An observation gives two candidates; priors add a few.
  constexpr std::size_t kPriors = 4;
  const std::size_t candidates = 2 * observations + kPriors;
  by_size_.reserve(observations);
  candidates_.reserve(candidates);
  starts_.reserve(candidates);
  optima_.reserve(candidates);
  ranked_.reserve(candidates);
}

bool RigPoseSolver::same(const Rigid3& a, const Rigid3& b) const {
  return angle_between_rad(a.rotation, b.rotation) < options_.distinct_rad &&
         (a.translation - b.translation).norm() < options_.distinct_m;
}

template <typename Bound>
double RigPoseSolver::sum(std::span<const FixedMarkerObservation> observations,
                          const Rigid3& world_from_rig, const Bound& bound) const {
  const Rigid3 rig_from_world = world_from_rig.inverse();
  double sum = 0;
  for (const FixedMarkerObservation& fixed : observations) {
    const auto camera = static_cast<std::size_t>(fixed.observation->camera);
    sum +=
        bound(squared_residual(*fixed.observation, *models_[camera],
                               cam_from_rig_[camera] * (rig_from_world * fixed.world_from_marker)));
  }
  return sum;
}

double RigPoseSolver::score(std::span<const FixedMarkerObservation> observations,
                            const Rigid3& world_from_rig) const {
  const double k2 = options_.score_scale_sigmas * options_.score_scale_sigmas;
  return sum(observations, world_from_rig, [k2](double s) { return k2 * std::log1p(s / k2); });
}

double RigPoseSolver::rank(std::span<const FixedMarkerObservation> observations,
                           const Rigid3& world_from_rig) const {
  if (!options_.bounded_score_sigmas) return score(observations, world_from_rig);
  const double k2 = *options_.bounded_score_sigmas * *options_.bounded_score_sigmas;
  return sum(observations, world_from_rig, [k2](double s) { return -k2 * std::expm1(-s / k2); });
}

void RigPoseSolver::add_candidate(std::span<const FixedMarkerObservation> observations,
                                  const FixedMarkerObservation& fixed,
                                  const Rigid3& cam_from_marker) {
  const Rigid3& cam_from_rig = cam_from_rig_[static_cast<std::size_t>(fixed.observation->camera)];
  const Rigid3 pose = fixed.world_from_marker * cam_from_marker.inverse() * cam_from_rig;
  candidates_.push_back({pose, score(observations, pose), candidates_.size()});
}

void RigPoseSolver::collect_candidates(std::span<const FixedMarkerObservation> observations) {
  candidates_.clear();
  if (options_.seed == RigPoseSeed::best_own_fit) {
    const FixedMarkerObservation* const best = best_own_fit(observations);
    if (best == nullptr) return;
    add_candidate(observations, *best, best->observation->ippe->cam_from_marker[0]);
    return;
  }
  by_size_.clear();
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (observations[i].observation->ippe) {
      by_size_.emplace_back(-area_px2(observations[i].observation->corners_px), i);
    }
  }
  std::sort(by_size_.begin(), by_size_.end());
  if (by_size_.size() > static_cast<std::size_t>(options_.max_seed_observations)) {
    by_size_.resize(static_cast<std::size_t>(options_.max_seed_observations));
  }
  for (const auto& [size, index] : by_size_) {
    for (const Rigid3& cam_from_marker : observations[index].observation->ippe->cam_from_marker) {
      add_candidate(observations, observations[index], cam_from_marker);
    }
  }
  sort_by_score(candidates_);
}

template <typename GivenUp>
std::optional<PoseOptimum> RigPoseSolver::refine(
    std::span<const FixedMarkerObservation> observations, const Rigid3& start,
    const ObservationLoss& loss, const GivenUp& given_up) const {
  WAYMARK_CHECK(loss.check().has_value());
  const auto linearize = [&](const Rigid3& world_from_rig) {
    PoseEquations equations;
    for (const FixedMarkerObservation& fixed : observations) {
      add_observation(*fixed.observation,
                      geometry(fixed.observation->camera, world_from_rig, fixed.world_from_marker),
                      loss, FreePose::rig, equations);
    }
    return equations;
  };
  return minimize_pose(start, options_.max_iterations, linearize, given_up);
}

std::optional<PoseOptimum> RigPoseSolver::refine(
    std::span<const FixedMarkerObservation> observations, const Rigid3& start,
    const ObservationLoss& loss) const {
  return refine(observations, start, loss, ToTheEnd{});
}

bool RigPoseSolver::beside_known(const Rigid3& world_from_rig) const {
  return std::any_of(optima_.begin(), optima_.end(),
                     [&](const PoseOptimum& known) { return same(known.pose, world_from_rig); });
}

void RigPoseSolver::keep_optimum(const PoseOptimum& optimum) {
  for (PoseOptimum& known : optima_) {
    if (same(known.pose, optimum.pose)) {
      if (optimum.cost < known.cost) known = optimum;
      return;
    }
  }
  optima_.push_back(optimum);
}

std::optional<RigPoseEstimate> RigPoseSolver::solve(
    std::span<const FixedMarkerObservation> observations, std::span<const Rigid3> priors) {
  collect_candidates(observations);
  optima_.clear();
  for (const Rigid3& prior : priors) {
    if (const auto optimum = refine(observations, prior)) keep_optimum(*optimum);
  }
  starts_.clear();
  for (const Candidate& candidate : candidates_) {
    if (starts_.size() == static_cast<std::size_t>(options_.max_refined)) break;
    // A start beside one already taken, or beside an optimum, leads nowhere else.
    const bool taken = std::any_of(starts_.begin(), starts_.end(), [&](const Rigid3& start) {
      return same(start, candidate.world_from_rig);
    });
    if (taken || beside_known(candidate.world_from_rig)) continue;
    starts_.push_back(candidate.world_from_rig);
    const auto optimum = refine(
        observations, starts_.back(), options_.loss,
        [&](const Rigid3& place) { return options_.give_up_beside_known && beside_known(place); });
    if (optimum) keep_optimum(*optimum);
  }
  if (optima_.empty()) return std::nullopt;
  // Ranked by score, not by Huber's cost: one wrong marker behind a camera must not outweigh three
  // right ones in front of it.
  ranked_.clear();
  for (std::size_t i = 0; i < optima_.size(); ++i) {
    ranked_.push_back({optima_[i].pose, rank(observations, optima_[i].pose), i});
  }
  sort_by_score(ranked_);
  RigPoseEstimate estimate;
  estimate.best = optima_[ranked_[0].index];
  if (ranked_.size() > 1) {
    estimate.runner_up = optima_[ranked_[1].index];
    estimate.ambiguous = ranked_[1].score - ranked_[0].score < options_.ambiguity_gap;
  }
  return estimate;
}

}  // namespace waymark
