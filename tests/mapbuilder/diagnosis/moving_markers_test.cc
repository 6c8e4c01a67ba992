#include "mapbuilder/diagnosis/moving_markers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/mapbuilder/diagnosis/diagnosed_room.h"

namespace waymark {
namespace {

constexpr int kBoardId = 40;

/// Shows a square of these markers where `rig_from_board` has them in every n-th set, seen by the
/// camera nearest.
void carry(test::SyntheticRoom& room, const std::vector<int>& numbers, double size_m,
           const std::function<std::optional<Rigid3>(std::size_t)>& rig_from_board) {
  for (ImageDetections& image : room.images) {
    const auto set = static_cast<std::size_t>((image.stamp - test::room_stamp(0)) /
                                              (test::room_stamp(1) - test::room_stamp(0)));
    const auto board = rig_from_board(set);
    if (!board) continue;
    const RigCamera& camera = room.rig.cameras[static_cast<std::size_t>(image.camera)];
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const Eigen::Vector3d on_board(1.3 * size_m * static_cast<double>(i % 3),
                                     1.3 * size_m * static_cast<double>(i / 3), 0);
      const Rigid3 cam_from_marker =
          camera.rig_from_cam.inverse() * *board * Rigid3{Eigen::Quaterniond::Identity(), on_board};
      Detection detection;
      detection.marker = {Family::tag36h11, numbers[i]};
      bool seen =
          (cam_from_marker.rotation * Eigen::Vector3d::UnitZ()).dot(cam_from_marker.translation) <
          0;
      const auto corners = marker_corners(size_m);
      for (std::size_t c = 0; c < 4 && seen; ++c) {
        const auto pixel = camera.model.project(cam_from_marker * corners[c]);
        seen = pixel && camera.model.in_image(*pixel);
        if (seen) detection.corners[c] = *pixel;
      }
      if (seen) image.detections.push_back(detection);
    }
  }
}

/// Before the first camera, facing it: x right, y up, z back to the camera.
Rigid3 before_first_camera(const test::SyntheticRoom& room, const Eigen::Vector3d& at,
                           double turn_rad = 0) {
  const Eigen::Quaterniond facing(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  return room.rig.cameras[0].rig_from_cam *
         Rigid3{(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitY()) * facing).normalized(), at};
}

class MovingMarkers : public test::DiagnosedRoom {};

TEST_F(MovingMarkers, AMarkerOnTheOwnBumperRidesAndIsInNoMap) {
  for (const double aside : {-0.3, 0.0, 0.4}) {
    test::SyntheticRoom room = test::noisy_room();
    const Rigid3 at = before_first_camera(room, {aside, 0.3, 1.2}, 0.2);
    carry(room, {kBoardId}, 0.1, [&](std::size_t) { return at; });
    build(room);
    expect_only(Cause::riding, kBoardId);
    EXPECT_EQ(mapped(kBoardId), nullptr);
    EXPECT_LT(worst_distance_m(room, {kBoardId}), 0.005);
  }
}

TEST_F(MovingMarkers, AMarkerOnAnotherVehicleMovesAllTheTime) {
  test::SyntheticRoom room = test::noisy_room();
  carry(room, {kBoardId}, 0.3, [&](std::size_t set) {
    const double s = static_cast<double>(set);
    return before_first_camera(room, {1.2 * std::sin(1.7 * s), 0.1, 2.5 + std::cos(2.3 * s)},
                               0.3 * std::sin(s));
  });
  build(room);
  expect_only(Cause::moved, kBoardId);
  EXPECT_EQ(mapped(kBoardId), nullptr);
}

TEST_F(MovingMarkers, ABoardWithIdsOfTheWallsIsAGroupAndTheWallsStayRight) {
  for (const int sets : {8, 14}) {
    test::SyntheticRoom room = test::noisy_room();
    carry(room, {0, 1, 2, 3, 4, 5}, 0.088, [&](std::size_t set) -> std::optional<Rigid3> {
      if (set % 4 != 0 || set / 4 >= static_cast<std::size_t>(sets)) return std::nullopt;
      const double s = static_cast<double>(set);
      return before_first_camera(room, {0.3 * std::sin(s) - 0.2, -0.1, 0.9 + 0.3 * std::cos(s)},
                                 0.4 * std::sin(2 * s));
    });
    build(room);
    std::size_t groups = 0;
    for (const Finding& finding : build_.findings) {
      groups += finding.cause == Cause::moving_group ? 1 : 0;
      for (const MarkerId& marker : finding.markers) EXPECT_LT(marker.number, 6) << titles();
    }
    EXPECT_EQ(groups, 1U) << titles();
    EXPECT_LT(worst_distance_m(room, {}), 0.01);
  }
}

// Two markers alone may agree by chance, and each is told by itself; stated ones are one cause.
TEST_F(MovingMarkers, TwoMarkersThatAreStatedToMoveTogetherAreAGroup) {
  for (const bool stated : {false, true}) {
    test::SyntheticRoom room = test::noisy_room();
    if (stated) {
      auto entries = room.catalog.entries();
      for (const int number : {kBoardId, kBoardId + 1}) {
        entries.front().group_by_id.emplace(number, "trolley");
      }
      room.catalog = MarkerCatalog(entries);
    }
    carry(room, {kBoardId, kBoardId + 1}, 0.3, [&](std::size_t set) {
      const double s = static_cast<double>(set);
      return before_first_camera(room, {std::sin(1.7 * s) - 0.2, 0.1, 2.5 + std::cos(2.3 * s)},
                                 0.3 * std::sin(s));
    });
    build(room);
    std::size_t groups = 0;
    for (const Finding& finding : build_.findings) {
      groups += finding.cause == Cause::moving_group ? 1 : 0;
    }
    EXPECT_EQ(groups, stated ? 1U : 0U) << titles();
    if (stated) {
      EXPECT_EQ(build_.findings.size(), 1U) << titles();
    }
    EXPECT_LT(worst_distance_m(room, {kBoardId, kBoardId + 1}), 0.01);
  }
}

TEST_F(MovingMarkers, NobodyMovesInASoundRoom) {
  build(test::noisy_room());
  expect_nobody();
}

}  // namespace
}  // namespace waymark
