#include "mapbuilder/report/plan_view.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

using Eigen::Vector3d;

/// A marker with its normal along `normal`, in a building whose z is up.
MapMarker marker(const Vector3d& position, const Vector3d& normal) {
  MapMarker m;
  m.size_m = 0.2;
  m.world_from_marker = {shortest_rotation(Vector3d::UnitZ(), normal), position};
  return m;
}

/// Four walls of a hall of 8 m × 3 m.
SubMap hall() {
  SubMap submap;
  for (int i = 0; i < 8; ++i) {
    submap.markers.push_back(marker({1.0 * i, 0, 1}, Vector3d::UnitY()));
    submap.markers.push_back(marker({1.0 * i, 3, 1.5}, -Vector3d::UnitY()));
  }
  for (int i = 0; i < 3; ++i) {
    submap.markers.push_back(marker({0, 1.0 * i, 1}, Vector3d::UnitX()));
    submap.markers.push_back(marker({8, 1.0 * i, 2}, -Vector3d::UnitX()));
  }
  return submap;
}

SubMap moved(SubMap submap, const Rigid3& world_from_building) {
  for (MapMarker& m : submap.markers) {
    m.world_from_marker = world_from_building * m.world_from_marker;
  }
  return submap;
}

const Rigid3 kSomewhere{so3_exp({0.7, -1.1, 0.4}), {5, -2, 1}};

/// How far (°) the plan's up is from the building's.
double up_error_deg(const PlanView& view, const Rigid3& world_from_building) {
  const Vector3d up = view.plan_from_world * (world_from_building.rotation * Vector3d::UnitZ());
  return std::acos(std::min(1.0, up.z())) * 180 / std::numbers::pi;
}

TEST(PlanView, AKnownUpIsKeptAsItIs) {
  SubMap facility = hall();
  facility.z_is_up = true;
  const PlanView view = plan_view(facility, -Vector3d::UnitZ());
  EXPECT_TRUE(view.z_is_up);
  EXPECT_TRUE(view.plan_from_world.isApprox(Eigen::Quaterniond::Identity()));
}

TEST(PlanView, WallsStandUprightWhateverTheWorldFrame) {
  const SubMap submap = moved(hall(), kSomewhere);
  // Cameras that lean 15° say roughly where up is; the walls say it exactly.
  const Vector3d leaning = so3_exp({0.26, 0, 0}) * Vector3d::UnitZ();
  const PlanView view = plan_view(submap, kSomewhere.rotation * leaning * 0.9);
  EXPECT_FALSE(view.z_is_up);
  EXPECT_LT(up_error_deg(view, kSomewhere), 0.01);
}

TEST(PlanView, WallsLieAlongThePageTheLongerWayAcross) {
  const SubMap submap = moved(hall(), kSomewhere);
  const PlanView view = plan_view(submap, kSomewhere.rotation * Vector3d::UnitZ());
  const Vector3d length = view.plan_from_world * (kSomewhere.rotation * Vector3d::UnitX());
  EXPECT_GT(std::abs(length.x()), 0.9999);
}

TEST(PlanView, MarkersOnTheFloorFaceUp) {
  SubMap floor;
  for (int i = 0; i < 20; ++i) {
    floor.markers.push_back(marker({1.0 * i, 0.5 * (i % 3), 0}, Vector3d::UnitZ()));
  }
  // A vehicle that turns while it looks down: its cameras' ups cancel out.
  const PlanView view = plan_view(moved(floor, kSomewhere), Vector3d::Zero());
  EXPECT_LT(up_error_deg(view, kSomewhere), 0.01);
}

TEST(PlanView, OneWallTakesTheRestFromTheCameras) {
  SubMap wall;
  for (int i = 0; i < 12; ++i) {
    wall.markers.push_back(marker({0.5 * i, 0, 0.3 * (i % 4)}, Vector3d::UnitY()));
  }
  const PlanView view =
      plan_view(moved(wall, kSomewhere), kSomewhere.rotation * Vector3d::UnitZ() * 0.95);
  EXPECT_LT(up_error_deg(view, kSomewhere), 0.5);
}

TEST(PlanView, OneMarkerIsEnough) {
  SubMap one;
  one.markers.push_back(marker({1, 2, 3}, Vector3d::UnitX()));
  for (const Vector3d& up : {Vector3d(0, 0, 1), Vector3d(0, 0, 0), Vector3d(1, 0, 0)}) {
    EXPECT_TRUE(plan_view(one, up).plan_from_world.coeffs().allFinite());
  }
}

}  // namespace
}  // namespace waymark
