#include "core/map/map_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/small_map.h"

namespace waymark {
namespace {

using ::testing::HasSubstr;

/// The message with which a map is refused after `change`; "fine" when it is accepted.
std::string verdict(const std::function<void(MarkerMap&)>& change) {
  MarkerMap map = test::small_map();
  change(map);
  const auto status = check_map(map);
  if (status) return "fine";
  EXPECT_EQ(status.error().kind, ErrorKind::bad_data);
  return status.error().message;
}

std::string marker_verdict(const std::function<void(MapMarker&)>& change) {
  const std::string message = verdict([&](MarkerMap& map) { change(map.submaps[0].markers[1]); });
  if (message != "fine") {
    EXPECT_THAT(message, HasSubstr("sub-map 0: marker tag36h11:"));
  }
  return message;
}

TEST(MapCheck, SoundMapsPass) {
  EXPECT_EQ(verdict([](MarkerMap&) {}), "fine");
  EXPECT_EQ(verdict([](MarkerMap& map) { map.rig_fingerprint.clear(); }), "fine");
  EXPECT_EQ(verdict([](MarkerMap& map) { map.capture_fingerprints.clear(); }), "fine");
  EXPECT_EQ(marker_verdict([](MapMarker& m) { m.covariance.setZero(); }), "fine");
  EXPECT_EQ(marker_verdict([](MapMarker& m) { m.covariance = 1e12 * Matrix6d::Identity(); }),
            "fine");
}

TEST(MapCheck, MapsWithoutMarkersAreRefused) {
  EXPECT_EQ(verdict([](MarkerMap& map) { map.submaps.clear(); }), "no markers");
  EXPECT_EQ(verdict([](MarkerMap& map) { map.submaps[1].markers.clear(); }),
            "sub-map 1: no markers");
}

TEST(MapCheck, IdsRiseOnceWithinTheirFamily) {
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.id.number = 2; }), HasSubstr("don't rise"));
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.id.number = 3; }), HasSubstr("twice"));
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.id.number = 587; }),
              HasSubstr("outside the family"));
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.id.number = -1; }),
              HasSubstr("outside the family"));
  EXPECT_EQ(verdict([](MarkerMap& map) { map.submaps[1].markers[1].id.number = 12; }),
            "sub-map 1: marker tag36h11:12: stands there twice");
}

TEST(MapCheck, SizesArePositiveAndInMetres) {
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.size_m = 0; }), HasSubstr("size"));
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.stated_size_m = -0.1; }), HasSubstr("size"));
  EXPECT_EQ(marker_verdict([](MapMarker& m) { m.size_m = 100; }), "fine");
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.size_m = 100.1; }), HasSubstr("size"));
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.size_m = std::nan(""); }), HasSubstr("size"));
}

TEST(MapCheck, PosesAreFiniteAndOfUnitNorm) {
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.world_from_marker.translation.y() = HUGE_VAL; }),
              HasSubstr("position"));
  EXPECT_THAT(
      marker_verdict([](MapMarker& m) { m.world_from_marker.translation.z() = std::nan(""); }),
      HasSubstr("position"));
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.world_from_marker.translation.x() = -1.1e6; }),
              HasSubstr("position"));
  EXPECT_EQ(marker_verdict([](MapMarker& m) { m.world_from_marker.rotation.coeffs() *= 1 + 9e-7; }),
            "fine");
  EXPECT_THAT(
      marker_verdict([](MapMarker& m) { m.world_from_marker.rotation.coeffs() *= 1 + 1.1e-6; }),
      HasSubstr("unit norm"));
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.world_from_marker.rotation.x() = std::nan(""); }),
              HasSubstr("unit norm"));
}

TEST(MapCheck, CovariancesAreSymmetricAndPositiveSemidefinite) {
  // The largest element is 3e-6.
  EXPECT_EQ(marker_verdict([](MapMarker& m) { m.covariance(5, 1) += 2.9e-15; }), "fine");
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.covariance(5, 1) += 3.1e-15; }),
              HasSubstr("not symmetric"));
  EXPECT_EQ(marker_verdict([](MapMarker& m) { m.covariance(3, 3) = -2.9e-15; }), "fine");
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.covariance(3, 3) = -3.1e-15; }),
              HasSubstr("not positive semidefinite"));
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.covariance(0, 4) = m.covariance(4, 0) = 1; }),
              HasSubstr("not positive semidefinite"));
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.covariance(2, 2) = std::nan(""); }),
              HasSubstr("not finite"));
  for (const double beyond : {1.1e12, 1e300}) {
    EXPECT_THAT(marker_verdict([&](MapMarker& m) { m.covariance = beyond * Matrix6d::Identity(); }),
                HasSubstr("beyond (1000 km)²"));
  }
  EXPECT_EQ(marker_verdict([](MapMarker& m) { m.covariance = unknown_covariance(); }), "fine");
  EXPECT_THAT(marker_verdict([](MapMarker& m) {
                m.covariance = unknown_covariance();
                m.covariance(0, 0) = 1;
              }),
              HasSubstr("not finite"));
}

// Modes have variance 1, so that a covariance with one is a sigma at most.
TEST(MapCheck, NoParameterHasMoreInCommonWithAModeThanItsSigma) {
  for (const double share : {0.5, 1.0, -1.0, 1.01, -3.0, 1e6}) {
    for (const Eigen::Index mode : {0, kMapModes - 1}) {
      MarkerMap map = test::considered_small_map();
      SubMap& submap = map.submaps[0];
      submap.parameters[0].cross[mode] = share * std::sqrt(submap.parameter_covariance(0, 0));
      const auto checked = check_map(map);
      EXPECT_EQ(checked.has_value(), std::abs(share) <= 1) << share;
      if (checked) continue;
      EXPECT_THAT(checked.error().message, HasSubstr("more in common with modes"));
    }
  }
}

TEST(MapCheck, CountsAndRmsAreInRange) {
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.observations = 0x80000000; }),
              HasSubstr("observations"));
  EXPECT_EQ(marker_verdict([](MapMarker& m) { m.observations = 0x7FFFFFFF; }), "fine");
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.rejected = 0xFFFFFFFF; }),
              HasSubstr("observations"));
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.rms_px = -0.1; }), HasSubstr("RMS"));
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.rms_px = HUGE_VAL; }), HasSubstr("RMS"));
  EXPECT_EQ(marker_verdict([](MapMarker& m) { m.rms_px = 1e6; }), "fine");
  EXPECT_THAT(marker_verdict([](MapMarker& m) { m.rms_px = 1e308; }), HasSubstr("RMS"));
  EXPECT_THAT(verdict([](MarkerMap& map) { map.submaps[1].rms_px = 1.1e6; }), HasSubstr("RMS"));
  EXPECT_THAT(verdict([](MarkerMap& map) { map.submaps[1].rms_px = -1; }), HasSubstr("sub-map 1"));
  EXPECT_THAT(verdict([](MarkerMap& map) { map.submaps[1].rms_all_px = std::nan(""); }),
              HasSubstr("sub-map 1"));
  EXPECT_THAT(verdict([](MarkerMap& map) { map.submaps[0].frame_sets = 0x80000000; }),
              HasSubstr("sub-map 0"));
}

TEST(MapCheck, DescriptionIsInOrder) {
  EXPECT_THAT(verdict([](MarkerMap& map) { std::swap(map.submaps[0], map.submaps[1]); }),
              HasSubstr("more markers than the one before"));
  EXPECT_THAT(verdict([](MarkerMap& map) { map.submaps[0].frame = static_cast<FrameKind>(3); }),
              HasSubstr("unknown kind of frame 3"));
  EXPECT_THAT(verdict([](MarkerMap& map) { map.submaps[0].frame = FrameKind::facility; }),
              HasSubstr("z is not up"));
  EXPECT_THAT(verdict([](MarkerMap& map) { map.rig_fingerprint = "0123"; }),
              HasSubstr("rig fingerprint"));
  EXPECT_THAT(verdict([](MarkerMap& map) { map.rig_fingerprint[3] = 'X'; }),
              HasSubstr("rig fingerprint"));
  EXPECT_THAT(verdict([](MarkerMap& map) { map.capture_fingerprints[0] = ""; }),
              HasSubstr("capture"));
  EXPECT_THAT(verdict([](MarkerMap& map) {
                std::swap(map.capture_fingerprints[0], map.capture_fingerprints[1]);
              }),
              HasSubstr("in order"));
  EXPECT_EQ(verdict([](MarkerMap& map) { map.builder_version = std::string(32, 'v'); }), "fine");
  EXPECT_THAT(verdict([](MarkerMap& map) { map.builder_version = std::string(33, 'v'); }),
              HasSubstr("builder version"));
}

}  // namespace
}  // namespace waymark
