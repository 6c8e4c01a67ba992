#include "mapbuilder/growth/marker_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/median.h"
#include "core/base/range.h"

namespace waymark {
namespace {

/// The rig pose of a view that suits a marker pose better, with its squared residual (sigmas²).
std::pair<const Rigid3*, double> better_rig_pose(const PlacementView& view,
                                                 const Rigid3& world_from_marker) {
  const auto residual = [&](const Rigid3& world_from_rig) {
    return squared_residual(*view.observation, *view.camera,
                            view.cam_from_rig * (world_from_rig.inverse() * world_from_marker));
  };
  const double first = residual(view.world_from_rig);
  if (!view.other_world_from_rig) return {&view.world_from_rig, first};
  const double second = residual(*view.other_world_from_rig);
  if (second < first) return {&*view.other_world_from_rig, second};
  return {&view.world_from_rig, first};
}

std::optional<PoseOptimum> refine(std::span<const PlacementView> views, const Rigid3& start,
                                  const PlacementOptions& options) {
  return minimize_pose(start, options.max_iterations, [&](const Rigid3& world_from_marker) {
    PoseEquations equations;
    for (const PlacementView& view : views) {
      const Rigid3& world_from_rig = *better_rig_pose(view, world_from_marker).first;
      add_observation(*view.observation,
                      {view.camera, view.cam_from_rig, world_from_rig, world_from_marker},
                      options.loss, FreePose::marker, equations);
    }
    return equations;
  });
}

/// How much worse than noise alone the views fit: the median of their squared residuals against
/// its expectation, at least 1. Rigs that stand a little wrong make every view misfit, and a gap
/// between hypotheses says as much less.
double misfit(std::span<const PlacementView> views, const Rigid3& world_from_marker) {
  std::vector<double> squared;
  squared.reserve(views.size());
  for (const PlacementView& view : views) {
    squared.push_back(better_rig_pose(view, world_from_marker).second);
  }
  return std::max(1.0, upper_median(squared) / kMedianOfChi2_8);
}

struct Hypothesis {
  Rigid3 world_from_marker;
  double score = 0;
};

std::vector<Hypothesis> scored_hypotheses(std::span<const PlacementView> views,
                                          const PlacementOptions& options) {
  std::vector<Hypothesis> hypotheses;
  const auto add = [&](const Rigid3& world_from_marker) {
    hypotheses.push_back({world_from_marker, placement_score(views, world_from_marker, options)});
  };
  for (const PlacementView& view : views) {
    if (!view.observation->ippe) continue;
    const Rigid3 rig_from_cam = view.cam_from_rig.inverse();
    for (const Rigid3& cam_from_marker : view.observation->ippe->cam_from_marker) {
      add(view.world_from_rig * rig_from_cam * cam_from_marker);
      if (view.other_world_from_rig) {
        add(*view.other_world_from_rig * rig_from_cam * cam_from_marker);
      }
    }
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.score < b.score; });
  return hypotheses;
}

}  // namespace

Status PlacementOptions::check() const {
  return RangeCheck()
      .part("loss", loss.check())
      .field("score_scale_sigmas", score_scale_sigmas, {5.0, 100.0})
      .field("max_refined", max_refined, {2, 50})
      .field("max_iterations", max_iterations, {1, 200})
      .field("distinct_rad", distinct_rad, {0.002, 0.5})
      .field("distinct_m", distinct_m, {0.001, 1.0})
      .status();
}

double placement_score(std::span<const PlacementView> views, const Rigid3& world_from_marker,
                       const PlacementOptions& options) {
  const double k2 = options.score_scale_sigmas * options.score_scale_sigmas;
  double score = 0;
  for (const PlacementView& view : views) {
    score += k2 * std::log1p(better_rig_pose(view, world_from_marker).second / k2);
  }
  return score;
}

std::optional<PlacementEstimate> place_marker(std::span<const PlacementView> views,
                                              const PlacementOptions& options) {
  const auto same = [&](const Rigid3& a, const Rigid3& b) {
    return angle_between_rad(a.rotation, b.rotation) < options.distinct_rad &&
           (a.translation - b.translation).norm() < options.distinct_m;
  };
  const std::vector<Hypothesis> hypotheses = scored_hypotheses(views, options);
  std::vector<PoseOptimum> optima;
  std::vector<Rigid3> starts;
  for (const Hypothesis& hypothesis : hypotheses) {
    if (starts.size() == static_cast<std::size_t>(options.max_refined)) break;
    // A start beside one already taken leads to the same optimum.
    const bool repeated = std::any_of(starts.begin(), starts.end(), [&](const Rigid3& taken) {
      return same(taken, hypothesis.world_from_marker);
    });
    if (repeated) continue;
    starts.push_back(hypothesis.world_from_marker);
    const auto optimum = refine(views, starts.back(), options);
    if (!optimum) continue;
    const auto known = std::find_if(optima.begin(), optima.end(), [&](const PoseOptimum& o) {
      return same(o.pose, optimum->pose);
    });
    if (known == optima.end()) {
      optima.push_back(*optimum);
    } else if (optimum->cost < known->cost) {
      *known = *optimum;
    }
  }
  if (optima.empty()) return std::nullopt;
  // Ranked as the rig pose solver ranks: a wrong view must not outweigh several right ones.
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t i = 0; i < optima.size(); ++i) {
    ranked.emplace_back(placement_score(views, optima[i].pose, options), i);
  }
  std::sort(ranked.begin(), ranked.end());
  PlacementEstimate estimate;
  estimate.best = optima[ranked[0].second];
  if (ranked.size() > 1) {
    estimate.runner_up = optima[ranked[1].second];
    estimate.gap = (ranked[1].first - ranked[0].first) / misfit(views, estimate.best.pose);
  }
  return estimate;
}

}  // namespace waymark
