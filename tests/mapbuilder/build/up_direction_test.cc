#include "mapbuilder/build/up_direction.h"

#include <gtest/gtest.h>

#include <random>

#include "core/geometry/so3.h"

namespace waymark {
namespace {

using Eigen::Vector3d;

/// Draws buildings whose z is up, in worlds that lie anyhow.
class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {
    const Vector3d axis(gauss(), gauss(), gauss());
    world_from_building = so3_exp(axis.normalized() * uniform(0, M_PI));
  }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double gauss() { return std::normal_distribution<double>()(random_); }

  /// A marker whose normal is about `normal`, off by 2°.
  void hang(const Vector3d& normal) {
    const Vector3d off(gauss() * 0.035, gauss() * 0.035, gauss() * 0.035);
    MapMarker marker;
    marker.world_from_marker.rotation =
        world_from_building * so3_exp(off) *
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), normal);
    submap.markers.push_back(marker);
  }
  void hang_walls(int count) {
    for (int i = 0; i < count; ++i) {
      const double way = M_PI_2 * static_cast<double>(i % 3);
      hang({std::cos(way), std::sin(way), 0});
    }
  }
  void lay_floor(int count) {
    for (int i = 0; i < count; ++i) hang(Vector3d::UnitZ());
  }
  /// Upward part of what was found; 1 is right, −1 upside down.
  [[nodiscard]] double upwards(const Vector3d& found) const {
    return (world_from_building.inverse() * found).z();
  }

  Eigen::Quaterniond world_from_building;
  SubMap submap;

 private:
  std::mt19937 random_;
};

constexpr unsigned kDraws = 1000;
/// Of normals that are off by 2° each; a draw of a thousand is off by 4°.
constexpr double kWithin5Degrees = 0.9962;

TEST(UpDirection, NoFloorOfAThousandIsUpsideDown) {
  for (unsigned seed = 0; seed < kDraws; ++seed) {
    Draw draw(seed);
    draw.lay_floor(10);
    // Cameras that look straight down and turn: their ups cancel out, but for a rest that points
    // anywhere.
    const Vector3d rest = Vector3d(draw.gauss(), draw.gauss(), draw.gauss()).normalized() * 0.25;
    const auto up = up_by_floor(draw.submap, rest);
    ASSERT_TRUE(up) << seed;
    EXPECT_GT(draw.upwards(*up), kWithin5Degrees) << seed;
  }
}

TEST(UpDirection, CamerasThatLookAslantTellFloorFromWalls) {
  for (unsigned seed = 0; seed < kDraws; ++seed) {
    Draw draw(seed);
    draw.lay_floor(6);
    draw.hang_walls(30);  // more of each than on the floor
    const double pitch = draw.uniform(-0.6, 0.6);
    const Vector3d leaning = draw.world_from_building * so3_exp({pitch, 0, 0}) * Vector3d::UnitZ();
    const auto up = up_by_floor(draw.submap, leaning * 0.9);
    ASSERT_TRUE(up) << seed;
    EXPECT_GT(draw.upwards(*up), kWithin5Degrees) << seed;
  }
}

TEST(UpDirection, OneWallNeverPassesForAFloor) {
  for (unsigned seed = 0; seed < kDraws; ++seed) {
    Draw draw(seed);
    for (int i = 0; i < 12; ++i) draw.hang(Vector3d::UnitY());
    const Vector3d upright =
        draw.world_from_building * so3_exp({draw.uniform(-0.2, 0.2), 0, 0}) * Vector3d::UnitZ();
    EXPECT_FALSE(up_by_floor(draw.submap, upright * draw.uniform(0.5, 1.0))) << seed;
    EXPECT_FALSE(up_by_walls(draw.submap, upright)) << "one wall leaves its turn open";
  }
}

TEST(UpDirection, CeilingsAreNoFloors) {
  Draw draw(1);
  for (int i = 0; i < 12; ++i) draw.hang(-Vector3d::UnitZ());
  draw.lay_floor(3);
  const Vector3d up = draw.world_from_building * Vector3d::UnitZ();
  const auto found = up_by_floor(draw.submap, up);
  ASSERT_TRUE(found);
  EXPECT_GT(draw.upwards(*found), kWithin5Degrees);
}

TEST(UpDirection, OneMarkerTellsNothing) {
  Draw draw(1);
  EXPECT_FALSE(up_by_floor(draw.submap, {}));
  draw.lay_floor(1);
  EXPECT_FALSE(up_by_floor(draw.submap, Vector3d::Zero()));
  EXPECT_FALSE(up_by_walls(draw.submap, Vector3d::Zero()));
}

TEST(UpDirection, WallsTakeTheirSignFromUprightCamerasAndNoneFromOthers) {
  for (unsigned seed = 0; seed < kDraws; ++seed) {
    Draw draw(seed);
    draw.hang_walls(12);
    draw.lay_floor(4);
    const double pitch = draw.uniform(-0.7, 0.7);
    const Vector3d leaning = draw.world_from_building * so3_exp({pitch, 0, 0}) * Vector3d::UnitZ();
    const auto up = up_by_walls(draw.submap, leaning * 0.9);
    ASSERT_TRUE(up) << seed;
    EXPECT_GT(draw.upwards(*up), kWithin5Degrees) << seed;
    EXPECT_FALSE(up_by_walls(draw.submap, Vector3d::Zero())) << seed;
  }
}

}  // namespace
}  // namespace waymark
