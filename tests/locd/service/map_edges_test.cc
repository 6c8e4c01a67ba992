#include "locd/service/map_edges.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

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

TEST(MapEdges, MeasuredOnesAreAskedForInTheRigFile) {
  const auto note = note_of_map_edges(map_with_edges(0.01), unsure_rig(), "hall.map");
  ASSERT_TRUE(note);
  EXPECT_NE(note->find("hall.map: the edges that cam1 sees"), std::string::npos) << *note;
}

TEST(MapEdges, NothingIsSaidOfOthers) {
  EXPECT_FALSE(note_of_map_edges(map_with_edges(0.2), unsure_rig(), "hall.map"));
  EXPECT_FALSE(note_of_map_edges({}, unsure_rig(), "hall.map"));
  EXPECT_FALSE(note_of_map_edges(map_with_edges(0.01), test::ring_rig(1), "hall.map"));
  Rig stated = unsure_rig();
  stated.cameras[1].edge_bias_px = 0;
  EXPECT_FALSE(note_of_map_edges(map_with_edges(0.01), stated, "hall.map"));
}

}  // namespace
}  // namespace waymark
