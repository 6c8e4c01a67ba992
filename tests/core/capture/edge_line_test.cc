#include "core/capture/edge_line.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(EdgeLine, ComesBackAsItWasWritten) {
  for (const std::optional<SensorResponse> response :
       {std::optional(SensorResponse::linear), std::optional(SensorResponse::srgb),
        std::optional<SensorResponse>()}) {
    const auto read = parse_edge_line(edge_line("cam 1", {-0.0625, 0.0125, response}));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->camera, "cam 1");
    EXPECT_EQ(read->edges.bias_px, -0.0625);
    EXPECT_EQ(read->edges.sigma_px, 0.0125);
    EXPECT_EQ(read->edges.response, response);
  }
  EXPECT_EQ(edge_line("cam0", {0.268, 0.009, SensorResponse::srgb}),
            "# edges camera=cam0 bias_px=0.2680 sigma_px=0.0090 response=srgb");
}

TEST(EdgeLine, AnythingElseIsNone) {
  for (const char* line :
       {"", "# edges", "# edges camera=cam0", "# edges camera=cam0 bias_px=0.1 sigma_px=0.01",
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
