#include "locd/pose/expected_windows.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

MarkerMap map_of(const test::SyntheticRoom& room, double size_m) {
  MarkerMap map;
  SubMap& submap = map.submaps.emplace_back();
  for (std::size_t i = 0; i < room.world_from_marker.size(); ++i) {
    MapMarker& marker = submap.markers.emplace_back();
    marker.id = {room.catalog.entries().front().family, static_cast<int>(i)};
    marker.size_m = marker.stated_size_m = size_m;
    marker.world_from_marker = room.world_from_marker[i];
    marker.covariance.diagonal().setConstant(1e-8);
  }
  return map;
}

class RoomWindows : public ::testing::Test {
 protected:
  /// The rig where it is, known to some millimetres and a tenth of a degree.
  [[nodiscard]] MotionPrediction prediction(std::size_t set) const {
    MotionPrediction prediction;
    prediction.world_from_rig = room_.world_from_rig[set];
    prediction.covariance.diagonal() << 1e-5, 1e-5, 1e-5, 3e-6, 3e-6, 3e-6;
    return prediction;
  }

  [[nodiscard]] std::span<const Detection> seen(std::size_t set, std::size_t camera) const {
    return room_.images[set * room_.rig.cameras.size() + camera].detections;
  }

  static bool is_well_inside(const ImageCorners& corners) {
    return std::all_of(corners.begin(), corners.end(), [](const Eigen::Vector2d& corner) {
      return std::min(corner.x(), corner.y()) > 8 && corner.x() < 1270 && corner.y() < 950;
    });
  }

  /// Whether some window has the marker with some light around it.
  static bool has(const std::vector<ImageWindow>& windows, const ImageCorners& corners) {
    return std::any_of(windows.begin(), windows.end(), [&](const ImageWindow& window) {
      return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& corner) {
        return corner.x() >= window.left_px + 4 && corner.y() >= window.top_px + 4 &&
               corner.x() <= window.left_px + window.width_px - 4 &&
               corner.y() <= window.top_px + window.height_px - 4;
      });
    });
  }

  test::RoomOptions options_;
  test::SyntheticRoom room_ = test::make_room(options_);
  MapIndex map_{map_of(room_, options_.marker_m)};
  ExpectedWindows windows_{room_.rig, map_};
};

TEST_F(RoomWindows, HoldWhatACameraSeesAndLeaveMostOut) {
  int guided = 0;
  for (std::size_t set = 0; set < room_.world_from_rig.size(); ++set) {
    windows_.predict(prediction(set));
    for (std::size_t camera = 0; camera < room_.rig.cameras.size(); ++camera) {
      const std::vector<ImageWindow>& windows = windows_.by_camera()[camera];
      if (windows.empty()) continue;
      ++guided;
      long area = 0;
      for (const ImageWindow& window : windows) area += window.area_px2();
      EXPECT_LE(area, 1280L * 960 / 2);
      for (const Detection& one : seen(set, camera)) {
        if (!is_well_inside(one.corners)) continue;
        EXPECT_TRUE(has(windows, one.corners)) << set << ' ' << camera << ' ' << one.marker.number;
      }
    }
  }
  EXPECT_GT(guided, 100) << "of 180 images";
}

TEST_F(RoomWindows, EveryCameraIsSearchedAsAWholeByTurns) {
  std::array<int, 3> wholes{};
  for (int set = 0; set < 4 * ExpectedWindows::kTurns; ++set) {
    windows_.predict(prediction(3));
    int at_once = 0;
    for (std::size_t camera = 0; camera < 3; ++camera) {
      if (!windows_.by_camera()[camera].empty()) continue;
      ++wholes[camera];
      ++at_once;
    }
    EXPECT_LE(at_once, 1);
  }
  for (const int count : wholes) EXPECT_EQ(count, 4);
}

TEST_F(RoomWindows, WithoutAPredictionAllIsSearched) {
  windows_.predict(prediction(3));
  windows_.predict(std::nullopt);
  for (const auto& windows : windows_.by_camera()) EXPECT_TRUE(windows.empty());
}

TEST_F(RoomWindows, WhatWasSeenUnexpectedlyIsLookedForAgain) {
  Detection stranger;
  stranger.marker = {Family::tag36h11, 500};
  stranger.corners = {{{600, 5}, {640, 5}, {640, 45}, {600, 45}}};
  for (std::size_t camera = 0; camera < 3; ++camera) windows_.remember(camera, {&stranger, 1});
  int looked = 0;
  for (int set = 0; set < 8; ++set) {
    windows_.predict(prediction(3));
    for (std::size_t camera = 0; camera < 3; ++camera) {
      const auto& windows = windows_.by_camera()[camera];
      if (windows.empty()) continue;
      ++looked;
      EXPECT_TRUE(std::any_of(windows.begin(), windows.end(), [](const ImageWindow& window) {
        return window.left_px <= 560 && window.left_px + window.width_px >= 680;
      }));
    }
  }
  EXPECT_GE(looked, 20);
}

TEST_F(RoomWindows, AnUnsurePredictionHasLargerWindowsUntilAllIsSearched) {
  windows_.predict(prediction(3));
  windows_.predict(prediction(3));
  const long before = windows_.by_camera()[0].front().area_px2();
  MotionPrediction unsure = prediction(3);
  unsure.covariance *= 30;
  windows_.predict(unsure);
  ASSERT_FALSE(windows_.by_camera()[0].empty());
  EXPECT_GT(windows_.by_camera()[0].front().area_px2(), before);
  unsure.covariance *= 1e4;
  windows_.predict(unsure);
  EXPECT_TRUE(windows_.by_camera()[0].empty());
}

}  // namespace
}  // namespace waymark
