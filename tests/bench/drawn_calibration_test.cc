#include "bench/drawn_calibration.h"

#include <gtest/gtest.h>

#include <map>

#include "bench/map_nees.h"
#include "mapbuilder/build/map_builder.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark::bench {
namespace {

test::SyntheticRoom room_of(int cameras, std::uint32_t seed) {
  test::RoomOptions options;
  options.cameras = cameras;
  options.markers = 16;
  options.frame_sets = 24;
  options.room_m = 6;
  options.noise_px = 0.1;
  options.seed = seed;
  return test::make_room(options);
}

/// The short form of bench_consider: maps of one room, each with a calibration of its own.
double mean_nees(int cameras, int seeds) {
  double sum = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const test::SyntheticRoom room = room_of(cameras, 1);
    const auto observations = make_observations(
        {with_drawn_calibration(test::capture_of(room), static_cast<std::uint64_t>(seed))}, {});
    EXPECT_TRUE(observations);
    Progress progress(false);
    const BuildResult built = build_map(Selection(*observations), {}, progress);
    std::map<MarkerId, Rigid3> truth;
    for (std::size_t i = 0; i < room.world_from_marker.size(); ++i) {
      truth[{Family::tag36h11, static_cast<int>(i)}] = room.world_from_marker[i];
    }
    sum += map_nees(built.submaps.at(0).map, truth).markers;
  }
  return sum / seeds;
}

TEST(DrawnCalibration, MetricSigmasHoldForARigsMap) {
  // Of 20 draws a mean scatters by a fifth or so: single ones by 0.4 to 3.
  const double nees = mean_nees(3, 20);
  EXPECT_GT(nees, 0.6);
  EXPECT_LT(nees, 1.6);
}

TEST(DrawnCalibration, MetricSigmasHoldForOneCamerasMap) {
  const double nees = mean_nees(1, 20);
  EXPECT_GT(nees, 0.5);
  EXPECT_LT(nees, 1.8);
}

TEST(DrawnCalibration, EverySeedIsAnother) {
  const auto exact = test::capture_of(room_of(3, 1));
  const auto one = with_drawn_calibration(exact, 1);
  EXPECT_NE(fingerprint(one.rig), fingerprint(exact.rig));
  EXPECT_NE(fingerprint(one.rig), fingerprint(with_drawn_calibration(exact, 2).rig));
  EXPECT_EQ(fingerprint(one), fingerprint(with_drawn_calibration(exact, 1)));
}

}  // namespace
}  // namespace waymark::bench
