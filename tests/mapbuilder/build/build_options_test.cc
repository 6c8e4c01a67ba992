#include "mapbuilder/build/build_options.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace waymark {
namespace {

TEST(BuildOptions, DefaultsAreWithinTheirRanges) { EXPECT_TRUE(check(BuildOptions{})); }

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
    const Status status = check(options);
    ASSERT_FALSE(status) << one.field;
    EXPECT_EQ(status.error().kind, ErrorKind::usage);
    EXPECT_NE(status.error().message.find(one.field), std::string::npos) << status.error().message;
  }
}

}  // namespace
}  // namespace waymark
