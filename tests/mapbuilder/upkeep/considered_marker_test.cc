#include "mapbuilder/upkeep/considered_marker.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

MapMarker marker_of(double sigma, float mode) {
  MapMarker marker;
  marker.covariance = sigma * sigma * Matrix6d::Identity();
  if (mode == 0.0F) return marker;
  marker.modes(0, 3) = mode;
  const Eigen::Matrix<double, 6, kMapModes> modes = marker.modes.cast<double>();
  marker.covariance_metric = marker.covariance + modes * modes.transpose();
  return marker;
}

TEST(ConsideredMarker, WhoStoodKeepsTheMapsModes) {
  const MapMarker before = marker_of(0.002, 0.5F);
  MapMarker after = marker_of(0.001, 0.25F);
  consider(&before, Rigid3{}, after);
  EXPECT_EQ(after.modes, before.modes);
  EXPECT_DOUBLE_EQ(after.covariance_metric(0, 0), 1e-6 + 0.25);
  EXPECT_DOUBLE_EQ(after.covariance_metric(1, 1), 1e-6);
}

TEST(ConsideredMarker, OfANewOneTheRoundsModesAreItsOwn) {
  MapMarker after = marker_of(0.001, 0.25F);
  Rigid3 quarter_turn;
  quarter_turn.rotation = so3_exp({0, 0, 1.5707963267948966});
  consider(nullptr, quarter_turn, after);
  EXPECT_TRUE(after.modes.isZero(0));
  EXPECT_NEAR(after.covariance_metric(0, 0), 1e-6, 1e-12);
  EXPECT_NEAR(after.covariance_metric(1, 1), 1e-6 + 0.0625, 1e-12);
}

TEST(ConsideredMarker, WhatNobodyConsidersStaysSo) {
  const MapMarker before = marker_of(0.002, 0);
  MapMarker after = marker_of(0.001, 0);
  consider(&before, Rigid3{}, after);
  EXPECT_FALSE(after.considered());
}

}  // namespace
}  // namespace waymark
