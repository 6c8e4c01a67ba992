#include "core/map/marker_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace waymark {
namespace {

MapMarker marker_at(const Eigen::Vector3d& position, const Eigen::Vector3d& sigmas) {
  MapMarker marker;
  marker.world_from_marker.translation = position;
  marker.covariance.diagonal().head<3>() = sigmas.cwiseAbs2();
  return marker;
}

TEST(MarkerDistance, CountsTheSigmaAlongTheLineBetween) {
  const MapMarker from = marker_at({1, 2, 3}, {0.003, 0.1, 0.1});
  const MapMarker to = marker_at({6, 2, 3}, {0.004, 0.1, 0.1});
  const MarkerDistance distance = distance_between(from, to, FrameKind::arbitrary);
  EXPECT_DOUBLE_EQ(distance.distance_m, 5.0);
  EXPECT_NEAR(*distance.sigma_m, 0.005, 1e-12);
  EXPECT_NEAR(*distance.sigma_bound_m, 0.007, 1e-12);
}

TEST(MarkerDistance, TheMetricSigmaIsKnownByMeasuredLengthsAlone) {
  const MapMarker from = marker_at({0, 0, 0}, {0.003, 0.003, 0.003});
  const MapMarker to = marker_at({0, 3, 4}, {0.004, 0.004, 0.004});
  EXPECT_FALSE(distance_between(from, to, FrameKind::arbitrary).sigma_metric_m);
  for (const FrameKind frame : {FrameKind::scaled, FrameKind::facility}) {
    const MarkerDistance distance = distance_between(from, to, frame);
    EXPECT_NEAR(*distance.sigma_metric_m, 0.007, 1e-12);
  }
}

TEST(MarkerDistance, IsTheScatterOfIndependentMarkersAndAtMostTheBoundOfDependentOnes) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  const MapMarker from = marker_at({0, 0, 0}, {0.003, 0.001, 0.002});
  const MapMarker to = marker_at({2, 1, -2}, {0.004, 0.002, 0.001});
  const auto moved = [&](const MapMarker& marker, const Eigen::Vector3d& by) {
    const Eigen::Vector3d sigmas = marker.covariance.diagonal().head<3>().cwiseSqrt();
    return Eigen::Vector3d(marker.world_from_marker.translation + sigmas.cwiseProduct(by));
  };
  const MarkerDistance distance = distance_between(from, to, FrameKind::arbitrary);
  double independent = 0;
  double dependent = 0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector3d a(normal(random), normal(random), normal(random));
    const Eigen::Vector3d b(normal(random), normal(random), normal(random));
    independent += std::pow((moved(to, b) - moved(from, a)).norm() - distance.distance_m, 2);
    dependent += std::pow((moved(to, -a) - moved(from, a)).norm() - distance.distance_m, 2);
  }
  EXPECT_NEAR(std::sqrt(independent / kDraws) / *distance.sigma_m, 1.0, 0.02);
  EXPECT_LT(std::sqrt(dependent / kDraws), 1.02 * *distance.sigma_bound_m);
}

TEST(MarkerDistance, WhatMarkersShareMakesNoDistanceUnsure) {
  MapMarker from = marker_at({0, 0, 0}, {0.003, 0.003, 0.003});
  MapMarker to = marker_at({2, 0, 0}, {0.004, 0.004, 0.004});
  const auto consider = [](MapMarker& marker, float along_x) {
    marker.modes(0, 2) = along_x;
    const Eigen::Matrix<double, 6, kMapModes> modes = marker.modes.cast<double>();
    marker.covariance_metric = marker.covariance + modes * modes.transpose();
  };
  consider(from, 0.25F);
  consider(to, 0.25F);
  const MarkerDistance alike = distance_between(from, to, FrameKind::arbitrary);
  EXPECT_NEAR(*alike.sigma_m, 0.005, 1e-12);
  EXPECT_NEAR(*alike.sigma_metric_m, 0.005, 1e-9);
  consider(to, -0.25F);
  EXPECT_NEAR(*distance_between(from, to, FrameKind::arbitrary).sigma_metric_m,
              std::hypot(0.005, 0.5), 1e-9);
}

TEST(MarkerDistance, NothingIsInvented) {
  MapMarker from = marker_at({0, 0, 0}, {0.003, 0.003, 0.003});
  const MapMarker to = marker_at({0, 0, 0}, {0.003, 0.003, 0.003});
  const MarkerDistance none = distance_between(from, to, FrameKind::facility);
  EXPECT_EQ(none.distance_m, 0.0);
  EXPECT_FALSE(none.sigma_m || none.sigma_bound_m || none.sigma_metric_m);
  from.world_from_marker.translation.x() = 1;
  from.covariance = unknown_covariance();
  const MarkerDistance unknown = distance_between(from, to, FrameKind::facility);
  EXPECT_EQ(unknown.distance_m, 1.0);
  EXPECT_FALSE(unknown.sigma_m || unknown.sigma_bound_m || unknown.sigma_metric_m);
}

}  // namespace
}  // namespace waymark
