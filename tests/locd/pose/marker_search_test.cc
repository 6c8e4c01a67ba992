#include "locd/pose/marker_search.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "tests/locd/pose/room_drive.h"

namespace waymark {
namespace {

using test::RoomDrive;

test::RoomOptions usual() {
  test::RoomOptions options;
  options.frame_sets = 4;
  return options;
}

TEST(MarkerSearch, TellsWhatEachCameraSeesWithoutAMap) {
  RoomDrive drive(test::make_room(usual()));
  MarkerSearch search(drive.room().rig, MarkerCatalog(), {});
  PoseEstimate estimate;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    const FrameSetLease set = drive.set(i);
    search.search(set, {}, estimate);
    EXPECT_EQ(estimate.status, PoseStatus::lost);
    EXPECT_TRUE(estimate.has(PoseReason::no_map));
    std::size_t given = 0;
    std::set<MarkerId> different;
    for (std::size_t c = 0; c < drive.room().rig.cameras.size(); ++c) {
      const auto& detections = set.frames[c].detections()->detections;
      given += detections.size();
      for (const Detection& detection : detections) different.insert(detection.marker);
    }
    ASSERT_GT(given, 0U);
    EXPECT_EQ(estimate.observations.size(), given);
    EXPECT_EQ(estimate.markers_seen, static_cast<int>(different.size()));
    EXPECT_EQ(search.unhealthy(), 0U);
  }
}

TEST(MarkerSearch, IgnoredMarkersAreToldAsSuch) {
  RoomDrive drive(test::make_room(usual()));
  MarkerSearch search(drive.room().rig, MarkerCatalog(), {});
  PoseEstimate estimate;
  search.search(drive.set(0), {}, estimate);
  const std::array ignored = {estimate.observations.front().marker};
  search.search(drive.set(1), ignored, estimate);
  for (const ObservedMarker& seen : estimate.observations) {
    EXPECT_EQ(seen.verdict == ObservationVerdict::ignored, seen.marker == ignored[0]);
  }
}

TEST(MarkerSearch, ImagesThatAreGivenAgainAreFrozenAndShowNothing) {
  RoomDrive drive(test::make_room(usual()));
  MarkerSearch search(drive.room().rig, MarkerCatalog(), {});
  PoseEstimate estimate;
  bool told = false;
  for (int i = 0; i < 8; ++i) {
    search.search(drive.set(0), {}, estimate);
    for (const Alert& alert : search.alerts()) {
      told = told || alert.kind == AlertKind::image_frozen;
    }
  }
  EXPECT_TRUE(told);
  EXPECT_NE(search.unhealthy(), 0U);
  EXPECT_TRUE(estimate.observations.empty());
}

}  // namespace
}  // namespace waymark
