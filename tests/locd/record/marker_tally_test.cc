#include "locd/record/marker_tally.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

/// A marker of 40 px around a place in an image.
ObservedMarker seen(int number, double x_px, int camera = 0, Family family = Family::tag36h11) {
  ObservedMarker marker;
  marker.marker = {family, number};
  marker.camera = static_cast<std::int16_t>(camera);
  marker.corners_px = {
      Eigen::Vector2d{x_px - 20, 80}, {x_px + 20, 80}, {x_px + 20, 120}, {x_px - 20, 120}};
  return marker;
}

void count(MarkerTally& tally, std::initializer_list<ObservedMarker> markers) {
  PoseEstimate estimate;
  estimate.observations.assign(markers);
  tally.count(estimate);
}

TEST(MarkerTally, WhoStandsStillMakesOneView) {
  MarkerTally tally;
  for (int i = 0; i < 100; ++i) count(tally, {seen(31, 100 + 0.1 * i), seen(7, 300)});
  EXPECT_EQ(tally.verdict(), "2 markers, 2 seen once: pass 7, 31 again");
}

TEST(MarkerTally, AnotherPlaceInTheImageOrAnotherCameraIsAnotherView) {
  MarkerTally tally;
  count(tally, {seen(1, 100), seen(2, 100), seen(3, 100)});
  count(tally, {seen(1, 119), seen(2, 121), seen(3, 100, 1)});
  EXPECT_EQ(tally.seen_once(), (std::vector<MarkerId>{{Family::tag36h11, 1}}));
  EXPECT_EQ(tally.verdict(), "3 markers, 1 seen once: pass 1 again");
  count(tally, {seen(1, 140)});
  EXPECT_EQ(tally.verdict(), "3 markers, each from several places");
}

TEST(MarkerTally, WithoutMarkersItSaysWhatToLookAt) {
  MarkerTally tally;
  EXPECT_EQ(tally.verdict().substr(0, 18), "no marker was seen");
  count(tally, {seen(1, 100)});
  tally.clear();
  EXPECT_EQ(tally.markers(), 0U);
}

TEST(MarkerTally, IgnoredMarkersDoNotCountAndFamiliesAreTold) {
  MarkerTally tally;
  ObservedMarker ignored = seen(1, 100);
  ignored.verdict = ObservationVerdict::ignored;
  count(tally, {ignored, seen(2, 100), seen(2, 100, 0, Family::tag16h5)});
  EXPECT_EQ(tally.markers(), 2U);
  EXPECT_NE(tally.verdict().find("tag16h5:2"), std::string::npos);
}

TEST(MarkerTally, OfMoreThanItHoldsItSaysThatThereAreMore) {
  MarkerTally tally(2);
  count(tally, {seen(1, 100), seen(4, 100), seen(7, 100)});
  EXPECT_EQ(tally.verdict(), "more than 2 markers, 2 seen once: pass 1, 4 again");
}

}  // namespace
}  // namespace waymark
