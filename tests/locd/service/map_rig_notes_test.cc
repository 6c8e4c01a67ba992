#include "locd/service/map_rig_notes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A map that is as sure of cam1's edges as `sigma_px`.
MarkerMap map_with_edges(double sigma_px) {
  MarkerMap map;
  SubMap& submap = map.submaps.emplace_back();
  submap.parameters.push_back({"cam0 k1", "", {}});
  submap.parameters.push_back({"cam1 edge bias", "", {}});
  submap.parameter_covariance = Eigen::Vector2d(1, sigma_px * sigma_px).asDiagonal();
  return map;
}

Rig unsure_rig() {
  Rig rig = test::ring_rig(2);
  for (RigCamera& camera : rig.cameras) camera.stated_sigmas.edge_px = 0.2;
  return rig;
}

MapRigNotes told(const MarkerMap& map, const Rig& rig) {
  return map_rig_notes(map, "maps/hall.map", rig, "rig.yaml");
}

TEST(MapRigNotes, WarnOfMeasuredEdgesAndNameTheFileThatStatesThem) {
  for (const double sigma_px : {0.005, 0.01, 0.05}) {
    EXPECT_THAT(told(map_with_edges(sigma_px), unsure_rig()).warnings,
                ElementsAre(testing::AllOf(
                    HasSubstr("maps/hall.map: how far inside the black edges are seen by cam1"),
                    HasSubstr("rig.yaml does not state it"), HasSubstr("maps/hall.yaml"))));
  }
}

TEST(MapRigNotes, WarnOfNoOther) {
  Rig stated = unsure_rig();
  stated.cameras[1].edge_bias_px = 0;
  EXPECT_THAT(told(map_with_edges(0.2), unsure_rig()).warnings, IsEmpty());
  EXPECT_THAT(told({}, unsure_rig()).warnings, IsEmpty());
  EXPECT_THAT(told(map_with_edges(0.01), test::ring_rig(1)).warnings, IsEmpty());
  EXPECT_THAT(told(map_with_edges(0.01), stated).warnings, IsEmpty());
}

TEST(MapRigNotes, TellOfAnotherCalibration) {
  MarkerMap map = map_with_edges(0.2);
  EXPECT_THAT(told(map, unsure_rig()).notes, IsEmpty());
  map.rig_fingerprint = "0123456789abcdef";
  EXPECT_THAT(told(map, unsure_rig()).notes,
              ElementsAre(HasSubstr("built with another calibration than rig.yaml")));
}

TEST(MapRigNotes, TellOfWhatIsNotUsedAndNotKnown) {
  MarkerMap map = map_with_edges(0.2);
  map.submaps.emplace_back();
  map.submaps.front().markers.emplace_back().covariance = unknown_covariance();
  Rig silent = unsure_rig();
  for (RigCamera& camera : silent.cameras) camera.stated_sigmas = {};
  EXPECT_THAT(told(map, silent).notes,
              ElementsAre(HasSubstr("2 sub-maps"), HasSubstr("of 1 of 1 markers is unknown"),
                          HasSubstr("rig.yaml: states no sigma")));
}

}  // namespace
}  // namespace waymark
