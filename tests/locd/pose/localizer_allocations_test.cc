// Poses, judgements and verdicts take no memory once some sets were seen.
#include <gtest/gtest.h>

#include "bench/allocation_count.h"
#include "core/camera/rig_parameters.h"
#include "tests/locd/pose/room_drive.h"

namespace waymark {
namespace {

test::RoomOptions usual() {
  test::RoomOptions options;
  options.frame_sets = 240;
  options.noise_px = 0.1;
  options.state_covariances = true;
  options.markers = 60;
  return options;
}

/// Allocations from the tenth set on, over one round.
std::uint64_t allocations_of(Localizer& localizer, const test::RoomDrive& drive) {
  constexpr std::size_t kWarm = 10;
  PoseEstimate estimate;
  std::uint64_t taken = 0;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    const FrameSetLease set = drive.set(i);
    const std::uint64_t before = bench::allocations().ours;
    localizer.localize(set, estimate);
    if (i >= kWarm) taken += bench::allocations().ours - before;
  }
  return taken;
}

TEST(LocalizerAllocations, AreNoneWhereNothingIsWrong) {
  test::RoomDrive drive(test::make_room(usual()));
  Localizer localizer(drive.room().rig, test::room_map(drive.room()), {});
  EXPECT_EQ(allocations_of(localizer, drive), 0U);
}

TEST(LocalizerAllocations, AreNoneWhereMarkersAndALensAreNamed) {
  test::RoomDrive drive(test::make_room(usual()));
  MarkerMap map = test::room_map(drive.room());
  map.submaps[0].markers[5].world_from_marker.translation += Eigen::Vector3d(0.06, 0.05, 0.0);
  Rig told = drive.room().rig;
  for (RigCamera& camera : told.cameras) camera.stated_sigmas = {};
  CameraParameters p = told.cameras[1].model.parameters();
  p.fu_px /= 1.02;
  p.fv_px /= 1.02;
  told.cameras[1].model = *CameraModel::create(p);
  Localizer localizer(told, map, {});
  EXPECT_EQ(allocations_of(localizer, drive), 0U);
}

}  // namespace
}  // namespace waymark
