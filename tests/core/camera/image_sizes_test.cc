#include "core/camera/image_sizes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <utility>

namespace waymark {
namespace {

Rig rig_of(std::initializer_list<std::pair<int, int>> sizes) {
  Rig rig;
  for (const auto& [width_px, height_px] : sizes) {
    const CameraParameters parameters{.width_px = width_px,
                                      .height_px = height_px,
                                      .fu_px = 1.0 * width_px,
                                      .fv_px = 1.0 * width_px,
                                      .pu_px = 0.5 * width_px,
                                      .pv_px = 0.5 * height_px};
    rig.cameras.push_back({fmt::format("cam{}", rig.cameras.size()),
                           *CameraModel::create(parameters),
                           {},
                           {},
                           {},
                           {},
                           {},
                           {}});
  }
  return rig;
}

TEST(ImageSizes, OfAllCamerasTogetherAreBounded) {
  EXPECT_TRUE(check_image_sizes(rig_of({{20'000, 5'000}, {20'000, 5'000}}), "rig.yaml"));
  const Status refused = check_image_sizes(rig_of({{20'000, 5'000}, {20'000, 5'001}}), "rig.yaml");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::bad_data);
  EXPECT_TRUE(refused.error().message.starts_with("rig.yaml: cam1: with 20000×5001 px"))
      << refused.error().message;
}

}  // namespace
}  // namespace waymark
