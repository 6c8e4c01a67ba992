#include "simulator/ray_table.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace waymark::simulator {
namespace {

TEST(RayTable, HoldsTheDirectionsOfPixelCornersAlsoBeyondTheImage) {
  const CameraModel camera = test::ring_rig(1).cameras[0].model;
  constexpr int kPadding = 3;
  const RayTable rays(camera, kPadding);
  EXPECT_EQ(rays.width_px(), camera.parameters().width_px);
  EXPECT_EQ(rays.height_px(), camera.parameters().height_px);
  for (const int corner_y : {-kPadding, 0, 481, rays.height_px() + kPadding}) {
    const RayTable::Row row = rays.row(corner_y);
    for (const int corner_x : {-kPadding, 0, 642, rays.width_px() + kPadding}) {
      const auto i = static_cast<std::size_t>(corner_x + kPadding);
      const Eigen::Vector3d ray(row.x[i], row.y[i], row.z[i]);
      const auto expected = camera.bearing({corner_x - 0.5, corner_y - 0.5});
      ASSERT_TRUE(expected);
      EXPECT_LT((ray.normalized() - *expected).norm(), 1e-5) << corner_x << " " << corner_y;
    }
  }
}

}  // namespace
}  // namespace waymark::simulator
