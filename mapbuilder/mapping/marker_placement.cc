#include "mapbuilder/mapping/marker_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

struct Hypothesis {
  Rigid3 world_from_marker;
  double score = 0;
};

std::vector<Hypothesis> scored_hypotheses(std::span<const PlacementView> views,
                                          const PlacementOptions& options) {
  const double k2 = options.score_scale_sigmas * options.score_scale_sigmas;
  std::vector<Hypothesis> hypotheses;
  const auto add = [&](const Rigid3& world_from_marker) {
    double score = 0;
    for (const PlacementView& view : views) {
      score += k2 * std::log1p(better_rig_pose(view, world_from_marker).second / k2);
    }
    hypotheses.push_back({world_from_marker, score});
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

double PlacementEstimate::gap() const {
  return runner_up ? runner_up->cost - best.cost : std::numeric_limits<double>::infinity();
}

double placement_cost(std::span<const PlacementView> views, const Rigid3& world_from_marker,
                      const ObservationLoss& loss) {
  double cost = 0;
  for (const PlacementView& view : views) {
    cost +=
        robust_cost(loss.loss, loss.scale_sigmas, better_rig_pose(view, world_from_marker).second);
  }
  return cost;
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
  std::stable_sort(optima.begin(), optima.end(),
                   [](const PoseOptimum& a, const PoseOptimum& b) { return a.cost < b.cost; });
  PlacementEstimate estimate{optima[0], std::nullopt};
  if (optima.size() > 1) estimate.runner_up = optima[1];
  return estimate;
}

}  // namespace waymark
