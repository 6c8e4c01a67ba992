#include "core/capture/edge_moves.h"

#include <gmock/gmock.h>

#include "core/camera/rig_parameters.h"
#include "core/capture/detections_csv_text.h"
#include "core/marker/marker_outline.h"
#include "tests/core/capture/csv_of_two_cameras.h"

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Where the corners truly are.
ImageCorners true_corners() {
  return {Eigen::Vector2d(100, 100), {140, 104}, {138, 146}, {98, 139}};
}

/// Corners of cam1 as they are written moved outward by some and read beside a rig file that states
/// another bias, or none.
class EdgeMoves : public test::CsvOfTwoCameras {
 protected:
  /// Text whose corners are the true ones moved outward by `px`.
  std::string written(double px, const std::vector<EdgeMove>& moves) const {
    std::vector<ImageDetections> images(1);
    images[0].stamp = Stamp(5);
    images[0].camera = 1;
    Detection& detection = images[0].detections.emplace_back();
    detection.marker = {Family::tag36h11, 3};
    detection.corners = true_corners();
    move_sides_in(-px, detection.corners);
    return format_detections_csv(images, rig_, catalog_, "waymark-2-own", moves);
  }

  /// How far outward of the true corners the sides of the only detection lie.
  static double moved_px(const DetectionsTable& table) {
    return -inset_px(table.images.at(0).detections.at(0).corners, true_corners());
  }
};

TEST_F(EdgeMoves, WhatWasMovedAsStatedMovesOnToWhatIsStatedNow) {
  for (const double before_px : {0.0, 0.25, -0.4}) {
    for (const std::optional<double> now_px :
         {std::optional<double>(), std::optional(0.0), std::optional(0.354), std::optional(-0.1)}) {
      rig_.cameras[1].edge_bias_px = now_px;
      const auto table = good(written(before_px, {{}, {before_px, std::nullopt}}));
      EXPECT_NEAR(moved_px(table), now_px.value_or(0), 2e-4) << before_px;
      EXPECT_THAT(widen_for_unknown_moves(table, rig_), IsEmpty());
    }
  }
}

TEST_F(EdgeMoves, InvertedPrintsMoveTheOtherWay) {
  auto entries = catalog_.entries();
  entries.front().inverted = true;
  catalog_ = MarkerCatalog(entries);
  rig_.cameras[1].edge_bias_px = 0.25;
  EXPECT_NEAR(moved_px(good(written(0, {{}, {}}))), -0.25, 2e-4);
}

TEST_F(EdgeMoves, WhatWasMeasuredStaysUnlessTheRigContradictsIt) {
  const EdgeMeasurement measured{0.354, 0.005, SensorResponse::srgb};
  const std::string text = written(0.354, {{}, {0.354, measured}});
  for (const std::optional<double> now_px :
       {std::optional<double>(), std::optional(0.354), std::optional(0.36)}) {
    rig_.cameras[1].edge_bias_px = now_px;
    EXPECT_NEAR(moved_px(good(text)), 0.354, 2e-4);
  }
  for (const double now_px : {0.0, 0.3, -0.354}) {
    rig_.cameras[1].edge_bias_px = now_px;
    const auto table = read(text);
    ASSERT_FALSE(table) << now_px;
    EXPECT_EQ(table.error().exit_code(), 65);
    EXPECT_THAT(table.error().message, HasSubstr("stale: cam1"));
    EXPECT_THAT(table.error().message, HasSubstr("detect again"));
  }
  rig_.cameras[1].edge_bias_px = 0;
  rig_.cameras[1].stated_sigmas.edge_px = 0.2;
  EXPECT_TRUE(read(text)) << "a bias that is as unsure as that contradicts nothing";
}

TEST_F(EdgeMoves, WhereNothingIsSaidAStatedBiasCountsAsUnsure) {
  const std::string text = written(0, {});
  auto table = good(text);
  EXPECT_THAT(widen_for_unknown_moves(table, rig_), IsEmpty());
  for (const double bias_px : {0.354, -0.1}) {
    rig_.cameras[1].edge_bias_px = bias_px;
    rig_.cameras[1].stated_sigmas.edge_px = 0.005;
    table = good(text);
    EXPECT_NEAR(moved_px(table), 0, 1e-4);
    EXPECT_THAT(widen_for_unknown_moves(table, rig_), ElementsAre("cam1"));
    EXPECT_EQ(sigmas_of(rig_.cameras[1]).edge_px, std::abs(bias_px));
  }
}

}  // namespace
}  // namespace waymark
