#include "mapbuilder/build/build_options.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/base/parallel.h"
#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

TEST(BuildOptions, DefaultsAreWithinTheirRanges) { EXPECT_TRUE(BuildOptions{}.check()); }

TEST(BuildOptions, WhatIsOutOfRangeOrNoNumberIsNamed) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    const char* field;
    std::function<void(BuildOptions&)> spoil;
  };
  const std::vector<Case> cases{
      {"gate.reject_sigmas", [](BuildOptions& o) { o.gate.reject_sigmas = kNaN; }},
      {"gate.reject_sigmas", [](BuildOptions& o) { o.gate.reject_sigmas = 2; }},
      {"loss.scale_sigmas", [](BuildOptions& o) { o.loss.scale_sigmas = kNaN; }},
      {"lambda_distance", [](BuildOptions& o) { o.noise.paper.lambda_distance = kNaN; }},
      {"max_angle_rad", [](BuildOptions& o) { o.noise.paper.max_angle_rad = 0; }},
      {"model_sigma_px", [](BuildOptions& o) { o.noise.model_sigma_px = 21; }},
      {"firm_markers", [](BuildOptions& o) { o.growth.firm_markers = 0; }},
      {"distinct_m", [](BuildOptions& o) { o.growth.placement.distinct_m = kNaN; }},
      {"max_passes", [](BuildOptions& o) { o.max_passes = 0; }},
      {"most_unsure", [](BuildOptions& o) { o.refinement_limits.most_unsure = kNaN; }},
      {"refinement_limits.size", [](BuildOptions& o) { o.refinement_limits.size = -1; }}};
  for (const Case& one : cases) {
    BuildOptions options;
    one.spoil(options);
    const Status status = options.check();
    ASSERT_FALSE(status) << one.field;
    EXPECT_EQ(status.error().kind, ErrorKind::usage);
    EXPECT_NE(status.error().message.find(one.field), std::string::npos) << status.error().message;
  }
}

TEST(BuildOptions, PartsAreHeldToTheirRanges) {
  expect_ranges<GrowthOptions>(
      {ranged("placement_gap", &GrowthOptions::placement_gap, {0, 1000}),
       ranged("firm_markers", &GrowthOptions::firm_markers, {1, 10}),
       ranged("max_placement_views", &GrowthOptions::max_placement_views, {2, 1000}),
       ranged("adjust_growth", &GrowthOptions::adjust_growth, {1.05, 10}),
       ranged("explained_sigmas2", &GrowthOptions::explained_sigmas2, {8, 100}),
       ranged("give_up_sigma_px", &GrowthOptions::give_up_sigma_px, {1, kLargestModelSigma})});
  expect_ranges<PlacementOptions>(
      {ranged("score_scale_sigmas", &PlacementOptions::score_scale_sigmas, {5, 100}),
       ranged("max_refined", &PlacementOptions::max_refined, {2, 50}),
       ranged("max_iterations", &PlacementOptions::max_iterations, {1, 200}),
       ranged("distinct_rad", &PlacementOptions::distinct_rad, {0.002, 0.5}),
       ranged("distinct_m", &PlacementOptions::distinct_m, {0.001, 1})});
  expect_ranges<RefinementLimits>(
      {ranged("position_m", &RefinementLimits::position_m, {1e-5, 1}),
       ranged("rotation_rad", &RefinementLimits::rotation_rad, {1e-5, 0.1}),
       ranged("focal", &RefinementLimits::focal, {1e-5, 0.1}),
       ranged("size", &RefinementLimits::size, {1e-5, 0.1}),
       ranged("most_unsure", &RefinementLimits::most_unsure, {2, 100})});
  expect_ranges<MapperOptions>({ranged("max_passes", &MapperOptions::max_passes, {1, 50}),
                                ranged("threads", &MapperOptions::threads, kThreads)});
  expect_ranges<NoiseModel>({ranged("model_sigma_px", &NoiseModel::model_sigma_px,
                                    {kSmallestModelSigma, kLargestModelSigma})});
  expect_ranges<OutlierGateOptions>({ranged("reject_sigmas", &OutlierGateOptions::reject_sigmas,
                                            OutlierGateOptions::kRejectSigmas)});
}

}  // namespace
}  // namespace waymark
