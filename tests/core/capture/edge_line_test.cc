#include "core/capture/edge_line.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(EdgeLine, ComesBackAsItWasWritten) {
  for (const std::optional<SensorResponse> response :
       {std::optional(SensorResponse::linear), std::optional(SensorResponse::srgb),
        std::optional<SensorResponse>()}) {
    for (const double sigma_px : {0.0125, 0.00003, 2.5}) {
      const EdgeMove move{-0.0625, EdgeMeasurement{-0.0625, sigma_px, response}};
      const auto read = parse_edge_line(edge_line("cam 1", move));
      ASSERT_TRUE(read) << edge_line("cam 1", move);
      EXPECT_EQ(read->camera, "cam 1");
      EXPECT_EQ(read->move.px, -0.0625);
      ASSERT_TRUE(read->move.measured);
      EXPECT_EQ(read->move.measured->bias_px, -0.0625);
      EXPECT_EQ(read->move.measured->sigma_px, sigma_px);
      EXPECT_EQ(read->move.measured->response, response);
    }
  }
  EXPECT_EQ(edge_line("cam0", {0.268, EdgeMeasurement{0.268, 0.009, SensorResponse::srgb}}),
            "# edges camera=cam0 bias_px=0.2680 sigma_px=0.009 response=srgb");
}

TEST(EdgeLine, WhatWasMovedAsStatedComesBackToTheLastBit) {
  for (const double px : {0.0, 0.1, -2.9, 0.35412345678901234}) {
    const auto read = parse_edge_line(edge_line("cam0", {px, std::nullopt}));
    ASSERT_TRUE(read) << px;
    EXPECT_EQ(read->move.px, px);
    EXPECT_FALSE(read->move.measured);
  }
  EXPECT_EQ(edge_line("cam0", {0.25, std::nullopt}), "# edges camera=cam0 moved_px=0.25");
}

TEST(EdgeLine, AnythingElseIsNone) {
  for (const char* line : {"", "# edges", "# edges camera=cam0", "# edges camera=cam0 moved_px=",
                           "# edges camera=cam0 moved_px=4", "# edges camera=cam0 moved_px=nan",
                           "# edges camera=cam0 moved_px=0.1 sigma_px=0.01",
                           "# edges camera=cam0 bias_px=0.1 sigma_px=0.01",
                           "# edges camera=cam0 bias_px=nan sigma_px=0.01 response=srgb",
                           "# edges camera=cam0 bias_px=0.1 sigma_px=0 response=srgb",
                           "# edges camera=cam0 bias_px=0.1 sigma_px=inf response=srgb",
                           "# edges camera=cam0 bias_px=30 sigma_px=0.01 response=srgb",
                           "# edges camera=cam0 bias_px=0.1 sigma_px=0.01 response=gamma",
                           "# edges camera=cam0 sigma_px=0.01 bias_px=0.1 response=open",
                           "# edges camera=cam0 response=open sigma_px=0.01 bias_px=0.1"}) {
    EXPECT_FALSE(parse_edge_line(line)) << line;
  }
}

}  // namespace
}  // namespace waymark
