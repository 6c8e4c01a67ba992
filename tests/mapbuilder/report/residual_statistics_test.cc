#include "mapbuilder/report/residual_statistics.h"

#include <gtest/gtest.h>

#include <numeric>

namespace waymark {
namespace {

const MarkerId kMarker{Family::tag36h11, 1};

ReportCamera camera(const std::string& name, int width_px, int height_px) {
  return {name, width_px, height_px, {(width_px - 1) / 2.0, (height_px - 1) / 2.0}};
}

/// Four corners at one pixel with one residual.
ReportObservation observation(std::size_t camera, const Eigen::Vector2d& pixel,
                              const Eigen::Vector2d& residual, bool accepted = true) {
  return {kMarker,
          camera,
          accepted,
          {{pixel, pixel, pixel, pixel}},
          {residual, residual, residual, residual}};
}

TEST(RoundStep, GoesUpToOneTwoFive) {
  EXPECT_DOUBLE_EQ(round_step(0.03), 0.05);
  EXPECT_DOUBLE_EQ(round_step(0.05), 0.05);
  EXPECT_DOUBLE_EQ(round_step(0.051), 0.1);
  EXPECT_DOUBLE_EQ(round_step(1.0), 1.0);
  EXPECT_DOUBLE_EQ(round_step(150), 200);
}

TEST(ResidualStatistics, NothingSeenIsNoMisfit) {
  const auto none = residual_statistics({}, {});
  EXPECT_EQ(none.corners, 0U);
  EXPECT_EQ(none.rms_px, 0.0);
  EXPECT_TRUE(none.by_camera.empty());
}

TEST(ResidualStatistics, OnlyAcceptedCornersCountTowardsRms) {
  const std::vector<ReportCamera> cameras{camera("cam0", 640, 480)};
  const std::vector<ReportObservation> seen{observation(0, {300, 200}, {3, 4}),
                                            observation(0, {300, 200}, {1000, 0}, false)};
  const auto statistics = residual_statistics(seen, cameras);
  EXPECT_EQ(statistics.corners, 4U);
  EXPECT_DOUBLE_EQ(statistics.rms_px, 5.0);
  EXPECT_DOUBLE_EQ(statistics.median_px, 5.0);
  EXPECT_EQ(statistics.histogram.rejected_beyond, 4U);
  EXPECT_EQ(statistics.by_camera[0].observations, 2U);
  EXPECT_EQ(statistics.by_camera[0].rejected, 1U);
}

TEST(ResidualStatistics, EveryCornerLandsInOneBin) {
  const std::vector<ReportCamera> cameras{camera("cam0", 640, 480)};
  std::vector<ReportObservation> seen;
  for (int i = 0; i < 200; ++i) {
    seen.push_back(observation(0, {3.0 * i, 2.0 * i}, {0.01 * i, 0}, i % 10 != 0));
  }
  seen.push_back(observation(0, {0, 0}, {1e12, 0}));
  const auto statistics = residual_statistics(seen, cameras);
  const auto& h = statistics.histogram;
  const auto sum = [](const std::vector<std::size_t>& counts) {
    return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  };
  EXPECT_EQ(sum(h.accepted) + h.accepted_beyond, 4U * 181);
  EXPECT_EQ(sum(h.rejected) + h.rejected_beyond, 4U * 20);
  EXPECT_EQ(h.accepted_beyond, 4U);  // the gross one does not stretch the axis
  std::size_t in_radii = 0;
  for (const RadiusBin& bin : statistics.by_radius) in_radii += bin.corners;
  EXPECT_EQ(in_radii, statistics.corners);
  std::size_t in_cells = 0;
  for (const ImageCell& cell : statistics.by_camera[0].cells) in_cells += cell.corners;
  EXPECT_EQ(in_cells, statistics.corners);
}

TEST(ResidualStatistics, ALensThatMagnifiesShowsAsOutwardResidualsThatGrow) {
  const std::vector<ReportCamera> cameras{camera("cam0", 640, 480)};
  std::vector<ReportObservation> seen;
  for (double x = 20; x < 620; x += 40) {
    for (double y = 20; y < 460; y += 40) {
      const Eigen::Vector2d pixel(x, y);
      seen.push_back(observation(0, pixel, 0.01 * (pixel - cameras[0].principal_point_px)));
    }
  }
  const auto statistics = residual_statistics(seen, cameras);
  double before = 0;
  for (const RadiusBin& bin : statistics.by_radius) {
    if (bin.corners == 0) continue;
    EXPECT_GT(bin.mean_radial_px, before);
    EXPECT_GE(bin.mean_radial_px, 0.01 * bin.from_px);
    EXPECT_LE(bin.mean_radial_px, 0.01 * bin.to_px);
    EXPECT_NEAR(bin.mean_tangential_px, 0, 1e-12);
    before = bin.mean_radial_px;
  }
  EXPECT_GT(before, 2.0);
}

TEST(ResidualStatistics, ATurnedCameraShowsAsResidualsAround) {
  const std::vector<ReportCamera> cameras{camera("cam0", 641, 481)};
  const std::vector<ReportObservation> seen{observation(0, {420, 240}, {0, 1}),
                                            observation(0, {320, 340}, {-1, 0}),
                                            observation(0, {220, 240}, {0, -1})};
  const auto statistics = residual_statistics(seen, cameras);
  const auto& bins = statistics.by_radius;
  const auto used =
      std::find_if(bins.begin(), bins.end(), [](const RadiusBin& bin) { return bin.corners > 0; });
  ASSERT_NE(used, bins.end());
  EXPECT_EQ(used->corners, 12U);
  EXPECT_DOUBLE_EQ(used->mean_tangential_px, 1.0);
  EXPECT_NEAR(used->mean_radial_px, 0, 1e-12);
}

TEST(ResidualStatistics, CamerasAreToldApart) {
  const std::vector<ReportCamera> cameras{camera("cam0", 640, 480), camera("cam1", 480, 640)};
  const std::vector<ReportObservation> seen{observation(0, {0, 0}, {1, 0}),
                                            observation(1, {479, 639}, {0, -2})};
  const auto statistics = residual_statistics(seen, cameras);
  EXPECT_DOUBLE_EQ(statistics.by_camera[0].rms_px, 1.0);
  EXPECT_DOUBLE_EQ(statistics.by_camera[1].rms_px, 2.0);
  EXPECT_EQ(statistics.by_camera[0].mean_px, Eigen::Vector2d(1, 0));
  EXPECT_EQ(statistics.by_camera[0].columns, 12);
  EXPECT_EQ(statistics.by_camera[0].rows, 9);
  EXPECT_EQ(statistics.by_camera[1].columns, 9);
  EXPECT_EQ(statistics.by_camera[1].rows, 12);
  EXPECT_EQ(statistics.by_camera[0].cells.front().corners, 4U);
  EXPECT_EQ(statistics.by_camera[1].cells.back().corners, 4U);
  EXPECT_EQ(statistics.by_camera[1].cells.back().mean_px, Eigen::Vector2d(0, -2));
}

}  // namespace
}  // namespace waymark
