#include "mapbuilder/upkeep/misfit.h"

#include <gtest/gtest.h>

#include <random>

namespace waymark {
namespace {

ComparedMarker off(int number, double distance_m) {
  ComparedMarker marker;
  marker.id = {Family::tag36h11, number};
  marker.distance_m = distance_m;
  marker.sigma_m = 0.001;
  return marker;
}

/// Markers off by three normal coordinates of so many mm, and a third of them by decimetres.
std::vector<ComparedMarker> scattered(double sigma_mm) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal(0, sigma_mm / 1e3);
  std::vector<ComparedMarker> markers;
  for (int i = 0; i < 600; ++i) {
    const Eigen::Vector3d offset(normal(random), normal(random), normal(random));
    markers.push_back(off(i % 500, offset.norm()));
  }
  return markers;
}

TEST(Misfit, IsWhatTheSigmasAreTooSmallBy) {
  EXPECT_NEAR(misfit_sigmas(scattered(3)), 3.0, 0.2);
  EXPECT_NEAR(misfit_sigmas(scattered(1)), 1.0, 0.1);
  EXPECT_EQ(misfit_sigmas(scattered(0.2)), 1.0);
}

TEST(Misfit, AFewThatWerePressedOnAgainDoNotShowInIt) {
  auto markers = scattered(1);
  for (std::size_t i = 0; i < markers.size(); i += 4) markers[i].distance_m = 0.009;
  EXPECT_LT(misfit_sigmas(markers), 1.5);
}

TEST(Misfit, FewMarkersDoNotTell) {
  const std::vector<ComparedMarker> four(4, off(1, 0.02));
  const std::vector<ComparedMarker> five(5, off(1, 0.02));
  EXPECT_EQ(misfit_sigmas(four), 1.0);
  EXPECT_GT(misfit_sigmas(five), 10.0);
}

TEST(Misfit, ShiftedIsBeyondFiveSigmasOfIt) {
  EXPECT_FALSE(is_shifted(off(1, 0.0049), 1));
  EXPECT_TRUE(is_shifted(off(1, 0.0051), 1));
  EXPECT_FALSE(is_shifted(off(1, 0.0051), 2));
  ComparedMarker unknown = off(1, 1);
  unknown.sigma_m.reset();
  EXPECT_FALSE(is_shifted(unknown, 1));
}

TEST(Misfit, WhoIsWithinItAndNotTurnedIsAcquitted) {
  FrameComparison comparison;
  comparison.stayed = {off(5, 0.001)};
  comparison.moved = {off(1, 0.02), off(2, 0.02), off(9, 0.03)};
  comparison.moved[1].turn_rad = 0.04;
  acquit(comparison, 5);
  ASSERT_EQ(comparison.stayed.size(), 2U);
  EXPECT_EQ(comparison.stayed[0].id.number, 1);
  ASSERT_EQ(comparison.moved.size(), 2U);
  EXPECT_EQ(comparison.moved[0].id.number, 2);
  EXPECT_EQ(comparison.moved[1].id.number, 9);
}

}  // namespace
}  // namespace waymark
