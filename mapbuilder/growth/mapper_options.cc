#include "mapbuilder/growth/mapper_options.h"

#include <limits>

#include "core/base/parallel.h"
#include "core/base/range.h"

namespace waymark {
namespace {

Status check(const NoiseModel& noise) {
  constexpr double kMost = std::numeric_limits<double>::max();
  constexpr double kPositive = std::numeric_limits<double>::min();
  const ObservationWeightOptions& paper = noise.paper;
  return RangeCheck()
      .field("noise.model_sigma_px", noise.model_sigma_px,
             {kSmallestModelSigma, kLargestModelSigma})
      .field("noise.paper.lambda_distance", paper.lambda_distance, {0.0, kMost})
      .field("noise.paper.lambda_angle", paper.lambda_angle, {0.0, kMost})
      .field("noise.paper.lambda_ambiguity", paper.lambda_ambiguity, {0.0, kMost})
      .field("noise.paper.epsilon_rad", paper.epsilon_rad, {kPositive, kMost})
      .field("noise.paper.max_distance_m", paper.max_distance_m, {kPositive, kMost})
      .field("noise.paper.max_angle_rad", paper.max_angle_rad, {kPositive, kMost})
      .status();
}

Status check(const GrowthOptions& growth) {
  const PlacementOptions& placement = growth.placement;
  return RangeCheck()
      .field("growth.placement_gap", growth.placement_gap, {0.0, 1000.0})
      .field("growth.firm_markers", growth.firm_markers, {1, 10})
      .field("growth.max_placement_views", growth.max_placement_views, {2, 1000})
      .field("growth.adjust_growth", growth.adjust_growth, {1.05, 10.0})
      .field("growth.explained_sigmas2", growth.explained_sigmas2, {8.0, 100.0})
      .field("growth.placement.score_scale_sigmas", placement.score_scale_sigmas, {5.0, 100.0})
      .field("growth.placement.max_refined", placement.max_refined, {2, 50})
      .field("growth.placement.max_iterations", placement.max_iterations, {1, 200})
      .field("growth.placement.distinct_rad", placement.distinct_rad, {0.002, 0.5})
      .field("growth.placement.distinct_m", placement.distinct_m, {0.001, 1.0})
      .status();
}

}  // namespace

Status check(const MapperOptions& options) {
  if (auto fine = check(options.noise); !fine) return fine;
  if (auto fine = check(options.growth); !fine) return fine;
  return RangeCheck()
      .field("loss.scale_sigmas", options.loss.scale_sigmas, {2.0, 50.0})
      .field("gate.reject_sigmas", options.gate.reject_sigmas, {3.0, 100.0})
      .field("max_passes", options.max_passes, {1, 50})
      .field("threads", options.threads, {0, 1024})
      .status();
}

MapperOptions effective(MapperOptions options) {
  options.growth.rig_pose.loss = options.loss;
  options.growth.placement.loss = options.loss;
  options.threads = effective_threads(options.threads);
  return options;
}

}  // namespace waymark
