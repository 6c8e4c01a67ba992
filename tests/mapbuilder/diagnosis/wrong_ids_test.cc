#include "mapbuilder/diagnosis/wrong_ids.h"

#include "tests/mapbuilder/diagnosis/diagnosed_room.h"

namespace waymark::test {
namespace {

class WrongIdsTest : public DiagnosedRoom {
 protected:
  /// Reads the `nth` detection of marker `id` that `take` agrees with as `other`.
  void misread(SyntheticRoom& room, int id, int nth, int other,
               const std::function<bool(const ImageDetections&)>& take) {
    int number = 0;
    for (ImageDetections& image : room.images) {
      for (Detection& d : image.detections) {
        if (d.marker.number != id || !take(image) || ++number != nth) continue;
        d.marker.number = other;
        stamp_ = image.stamp;
      }
    }
    ASSERT_TRUE(stamp_);
  }

  void expect_named(int read, int truly) const {
    expect_only(Cause::wrong_id, read);
    const std::string& evidence = build_.findings.front().text;
    EXPECT_NE(evidence.find(std::to_string(stamp_->count())), std::string::npos) << evidence;
    EXPECT_NE(evidence.find("it is marker " + std::to_string(truly) + "."), std::string::npos)
        << evidence;
  }

  std::optional<Stamp> stamp_;
};

bool shows(const ImageDetections& image, int id) {
  return std::any_of(image.detections.begin(), image.detections.end(),
                     [&](const Detection& d) { return d.marker.number == id; });
}

TEST_F(WrongIdsTest, areNamedWithTheMarkerTheyShow) {
  SyntheticRoom room = noisy_room();
  misread(room, 11, 5, 25, [](const auto& image) { return !shows(image, 25); });
  build(room);
  expect_named(25, 11);
  ASSERT_NE(mapped(25), nullptr);
  EXPECT_LT(worst_distance_m(room, {}), 0.01);
}

TEST_F(WrongIdsTest, areNamedBesideTheTrueOneInTheSameImage) {
  SyntheticRoom room = noisy_room();
  misread(room, 11, 2, 15, [](const auto& image) { return shows(image, 15); });
  build(room);
  expect_named(15, 11);
}

TEST_F(WrongIdsTest, thatNoMarkerHasAreNoMarkers) {
  SyntheticRoom room = noisy_room();
  misread(room, 11, 5, 200, [](const auto&) { return true; });
  build(room);
  expect_named(200, 11);
  EXPECT_EQ(mapped(200), nullptr);
}

TEST_F(WrongIdsTest, areNamedWhereOneOtherMarkerContradictsThem) {
  SyntheticRoom room = noisy_room();
  // One frame set is left with two markers of one image.
  for (ImageDetections& image : room.images) {
    if (image.stamp != room_stamp(20)) continue;
    if (image.camera != 0) image.detections.clear();
    ASSERT_TRUE(image.camera != 0 || image.detections.size() >= 2);
    if (image.camera == 0) image.detections.resize(2);
  }
  int truly = -1;
  edit(room, [&](Detection& d, Stamp stamp) {
    if (stamp != room_stamp(20) || truly >= 0) return true;
    truly = d.marker.number;
    d.marker.number = (truly + 14) % 30;
    return true;
  });
  stamp_ = room_stamp(20);
  build(room);
  expect_named((truly + 14) % 30, truly);
}

TEST_F(WrongIdsTest, aSoundMarkerHalfASideOffIsNotNamed) {
  // Corners that lie off, by a reflection say, are rejected and nothing more.
  SyntheticRoom room = noisy_room();
  int number = 0;
  edit(room, [&](Detection& d, Stamp) {
    if (d.marker.number != 11 || ++number != 5) return true;
    const double shift_px = 0.4 * std::sqrt(area_px2(d.corners));
    for (Eigen::Vector2d& corner : d.corners) corner.x() += shift_px;
    return true;
  });
  build(room);
  expect_nobody();
}

}  // namespace
}  // namespace waymark::test
