#include "locd/pose/riding_watch.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/locd/pose/room_drive.h"

namespace waymark {
namespace {

/// A rig walks through a room; some markers hang before its first camera.
class Riding : public testing::Test {
 protected:
  static test::SyntheticRoom room() {
    test::RoomOptions options;
    options.noise_px = 0.1;
    return test::make_room(options);
  }

  /// Markers that are told in one round of the room, `riding` of them moving along from set
  /// `begins` on, standing still if asked.
  std::multiset<std::size_t> look(const std::set<int>& riding, bool standing) {
    std::multiset<std::size_t> told;
    for (std::size_t i = 0; i < drive_.size(); ++i) {
      std::vector<SetObservation> observations;
      const FrameSetLease set = drive_.set(standing ? 0 : i);
      for (std::size_t c = 0; c < drive_.room().rig.cameras.size(); ++c) {
        for (const Detection& detection : set.frames[c].detections()->detections) {
          if (riding.contains(detection.marker.number)) continue;
          observations.push_back(
              observation(static_cast<int>(c), detection.marker, detection.corners));
        }
      }
      for (const int number : riding) observations.push_back(ahead(number));
      for (const std::size_t marker : watch_.look(observations)) told.insert(marker);
    }
    return told;
  }

  [[nodiscard]] SetObservation observation(int camera, const MarkerId& marker,
                                           const ImageCorners& corners) const {
    SetObservation o;
    o.observation.camera = camera;
    o.map_index = *map_.find(marker);
    o.observation.size_m = map_.marker(o.map_index).size_m;
    o.detected_px = o.observation.corners_px = corners;
    return o;
  }
  [[nodiscard]] SetObservation ahead(int number) const {
    const Rigid3 cam_from_marker{so3_exp({M_PI, 0, 0}),
                                 {0.3 * (number % 3) - 0.3, 0.2, distance_m_}};
    const auto x = marker_corners(map_.marker(0).size_m);
    ImageCorners corners;
    for (std::size_t i = 0; i < 4; ++i)
      corners[i] = *solver_.model(0).project(cam_from_marker * x[i]);
    return observation(0, {map_.marker(0).id.family, number}, corners);
  }

  double distance_m_ = 1.5;  ///< at which riding markers hang before the first camera
  test::RoomDrive drive_{room()};
  MapIndex map_{test::room_map(drive_.room())};
  RigPoseSolver solver_{drive_.room().rig, {}};
  RidingWatch watch_{map_, solver_};
};

TEST_F(Riding, MarkersAreToldOnceWhileOthersPassBy) {
  EXPECT_EQ(look({3, 4, 5}, false), (std::multiset<std::size_t>{3, 4, 5}));
}

TEST_F(Riding, WhatIsFarAwayMayOnlySeemToStay) {
  distance_m_ = 0.95 * RidingWatch::kFarthest_m;
  EXPECT_EQ(look({3}, false).size(), 1U);
  distance_m_ = 1.05 * RidingWatch::kFarthest_m;
  EXPECT_TRUE(look({4}, false).empty());
}

TEST_F(Riding, NobodyDoesInARoomThatStands) { EXPECT_TRUE(look({}, false).empty()); }

TEST_F(Riding, AStandingVehicleTellsNothing) { EXPECT_TRUE(look({3, 4, 5}, true).empty()); }

}  // namespace
}  // namespace waymark
