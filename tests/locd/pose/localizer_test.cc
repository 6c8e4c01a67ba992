#include "locd/pose/localizer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/geometry/symmetric_factor.h"
#include "tests/locd/pose/room_drive.h"

namespace waymark {
namespace {

using test::RoomDrive;
using testing::HasSubstr;

test::RoomOptions usual(int frame_sets = 60) {
  test::RoomOptions options;
  options.frame_sets = frame_sets;
  options.noise_px = 0.1;
  options.state_covariances = true;
  return options;
}

std::vector<QuarantinedMarker> quarantine_of(Localizer& localizer) {
  std::vector<QuarantinedMarker> list;
  localizer.list_quarantine(list);
  return list;
}

TEST(Localizer, PosesAreWithinTheirCovariance) {
  RoomDrive drive(test::make_room(usual(200)));
  Localizer localizer(drive.room().rig, test::room_map(drive.room()), {});
  PoseEstimate estimate;
  double nees = 0;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    localizer.localize(drive.set(i), estimate);
    ASSERT_EQ(estimate.status, PoseStatus::ok) << i << " reasons " << estimate.reasons;
    const Vector6d error = estimate.world_from_rig.minus(drive.room().world_from_rig[i]);
    EXPECT_LT(error.head<3>().norm(), 0.003);
    nees += error.dot(SymmetricFactor<6>(estimate.covariance).solve(error));
    EXPECT_NEAR(estimate.rms_px, 0.14, 0.08);
    EXPECT_EQ(estimate.outliers, 0);
    EXPECT_EQ(estimate.stamp, test::room_stamp(static_cast<int>(i)));
  }
  // 6 ± 4 sigma of the mean of 200.
  EXPECT_NEAR(nees / static_cast<double>(drive.size()), 6.0, 4 * std::sqrt(12.0 / 200));
}

TEST(Localizer, IsTheSameEveryTime) {
  RoomDrive drive(test::make_room(usual(30)));
  const MarkerMap map = test::room_map(drive.room());
  Localizer one(drive.room().rig, map, {});
  Localizer two(drive.room().rig, map, {});
  PoseEstimate a;
  PoseEstimate b;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    one.localize(drive.set(i), a);
    two.localize(drive.set(i), b);
    EXPECT_EQ(a.world_from_rig.translation, b.world_from_rig.translation);
    EXPECT_EQ(a.world_from_rig.rotation.coeffs(), b.world_from_rig.rotation.coeffs());
    EXPECT_EQ(a.covariance, b.covariance);
  }
}

TEST(Localizer, OnMarkersOfUnknownUncertaintyNoPoseIsOk) {
  RoomDrive drive(test::make_room(usual(30)));
  MarkerMap map = test::room_map(drive.room());
  for (MapMarker& marker : map.submaps[0].markers) marker.covariance = unknown_covariance();
  Localizer localizer(drive.room().rig, map, {});
  PoseEstimate estimate;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    localizer.localize(drive.set(i), estimate);
    EXPECT_EQ(estimate.status, PoseStatus::degraded) << i;
    EXPECT_NE(estimate.reasons & bit(PoseReason::sigma), 0U) << i;
    // The best estimate there is, said to be no better than what it rests on.
    const Vector6d error = estimate.world_from_rig.minus(drive.room().world_from_rig[i]);
    EXPECT_LT(error.head<3>().norm(), 0.05);
    EXPECT_GT(std::sqrt(estimate.covariance.topLeftCorner<3, 3>().trace()), 0.02);
    EXPECT_EQ(estimate.outliers, 0);
  }
}

TEST(Localizer, WithoutMappedMarkersEveryEstimateIsNaN) {
  RoomDrive drive(test::make_room(usual(3)));
  MarkerMap map = test::room_map(drive.room());
  for (MapMarker& marker : map.submaps[0].markers) marker.id.number += 500;
  Localizer localizer(drive.room().rig, map, {});
  PoseEstimate estimate;
  localizer.localize(drive.set(0), estimate);
  EXPECT_EQ(estimate.status, PoseStatus::lost);
  EXPECT_EQ(estimate.reasons, bit(PoseReason::no_markers));
  EXPECT_TRUE(estimate.world_from_rig.translation.array().isNaN().all());
  EXPECT_TRUE(estimate.covariance.array().isNaN().all());
  EXPECT_TRUE(std::isnan(estimate.rms_px));
  EXPECT_GT(estimate.markers_seen, 0);
  EXPECT_EQ(estimate.observations.front().verdict, ObservationVerdict::unknown);
}

TEST(Localizer, AMissingCameraIsSaidAndThePoseGoesOn) {
  RoomDrive drive(test::make_room(usual()));
  Localizer localizer(drive.room().rig, test::room_map(drive.room()), {});
  PoseEstimate estimate;
  for (std::size_t i = 0; i < 10; ++i) {
    FrameSetLease set = drive.set(i);
    if (i >= 5) {
      set.frames[1].release();
      set.frames[1] = Frame();
      set.cameras &= ~camera_bit(1);
    }
    localizer.localize(set, estimate);
    EXPECT_EQ(estimate.has(PoseReason::camera_missing), i >= 5);
    EXPECT_EQ(estimate.status, i >= 5 ? PoseStatus::degraded : PoseStatus::ok);
    EXPECT_LT(estimate.world_from_rig.minus(drive.room().world_from_rig[i]).norm(), 0.01);
  }
}

TEST(Localizer, AMovedMarkerHasNoPullIsNamedAndQuarantined) {
  RoomDrive drive(test::make_room(usual(120)));
  MarkerMap map = test::room_map(drive.room());
  // Where the map says is not where it hangs.
  map.submaps[0].markers[5].world_from_marker.translation += Eigen::Vector3d(0.06, 0.05, 0.0);
  Localizer localizer(drive.room().rig, map, {});
  PoseEstimate estimate;
  std::set<MarkerId> named;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    localizer.localize(drive.set(i), estimate);
    EXPECT_LT(estimate.world_from_rig.minus(drive.room().world_from_rig[i]).head<3>().norm(), 0.003)
        << i;
    for (const Alert& alert : localizer.alerts()) {
      ASSERT_EQ(alert.kind, AlertKind::marker_moved);
      named.insert(*alert.marker);
      EXPECT_NEAR(alert.offset_m, 0.078, 0.03);
    }
  }
  EXPECT_EQ(named, std::set<MarkerId>{map.submaps[0].markers[5].id});
  ASSERT_TRUE(localizer.quarantine_changed());
  const auto quarantine = quarantine_of(localizer);
  ASSERT_EQ(quarantine.size(), 1U);
  EXPECT_EQ(quarantine[0].marker, map.submaps[0].markers[5].id);
  EXPECT_FALSE(localizer.quarantine_changed());

  // A restart knows it from the first set on.
  Localizer restarted(drive.room().rig, map, {});
  restarted.restore_quarantine(quarantine);
  for (std::size_t i = 0; i < drive.size(); ++i) {
    restarted.localize(drive.set(i), estimate);
    for (const ObservedMarker& seen : estimate.observations) {
      EXPECT_EQ(seen.verdict == ObservationVerdict::quarantined,
                seen.marker == quarantine[0].marker);
    }
  }
}

TEST(Localizer, AMarkerPutBackIsUsedAgain) {
  RoomDrive drive(test::make_room(usual(150)));
  const MarkerMap map = test::room_map(drive.room());
  Localizer localizer(drive.room().rig, map, {});
  const QuarantinedMarker was{map.submaps[0].markers[5].id, QuarantineState::moved, 0, 0.1};
  localizer.restore_quarantine(std::span(&was, 1));
  PoseEstimate estimate;
  int over = 0;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    localizer.localize(drive.set(i), estimate);
    for (const Alert& alert : localizer.alerts()) over += alert.raised ? 0 : 1;
  }
  EXPECT_EQ(over, 1);
  EXPECT_TRUE(quarantine_of(localizer).empty());
}

TEST(Localizer, AnUnmappedMarkerIsNamedOnce) {
  RoomDrive drive(test::make_room(usual(60)));
  MarkerMap map = test::room_map(drive.room());
  const MarkerId unknown = map.submaps[0].markers[7].id;
  map.submaps[0].markers.erase(map.submaps[0].markers.begin() + 7);
  Localizer localizer(drive.room().rig, map, {});
  PoseEstimate estimate;
  int named = 0;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    localizer.localize(drive.set(i), estimate);
    for (const Alert& alert : localizer.alerts()) {
      EXPECT_EQ(alert.kind, AlertKind::marker_unknown);
      EXPECT_EQ(alert.marker, unknown);
      ++named;
    }
  }
  EXPECT_EQ(named, 1);
}

TEST(Localizer, ATurnedCameraIsNamed) {
  auto options = usual(200);
  options.markers = 60;
  RoomDrive drive(test::make_room(options));
  Rig rig = drive.room().rig;
  rig.cameras[1].rig_from_cam.rotation =
      rig.cameras[1].rig_from_cam.rotation * so3_exp({0.01, 0.01, 0.01});
  Localizer localizer(rig, test::room_map(drive.room()), {});
  PoseEstimate estimate;
  std::optional<Alert> named;
  for (std::size_t i = 0; i < drive.size() && !named; ++i) {
    localizer.localize(drive.set(i), estimate);
    for (const Alert& alert : localizer.alerts()) named = alert;
  }
  ASSERT_TRUE(named);
  EXPECT_EQ(named->kind, AlertKind::extrinsics_off);
  EXPECT_EQ(named->camera, 1);
  EXPECT_NEAR(named->offset_rad, 0.0173, 0.003);
}

TEST(Localizer, SwappedCamerasAreNamed) {
  auto options = usual(100);
  options.markers = 60;
  options.cameras = 5;
  // Three neighbours of a ring of five: in a whole ring every swap looks like every other one, seen
  // from a rig that is turned.
  auto room = test::make_room(options);
  room.rig.cameras.erase(room.rig.cameras.begin() + 3, room.rig.cameras.end());
  std::erase_if(room.images, [](const ImageDetections& image) { return image.camera >= 3; });
  RoomDrive drive(std::move(room));
  Rig rig = drive.room().rig;
  std::swap(rig.cameras[0].rig_from_cam, rig.cameras[2].rig_from_cam);
  Localizer localizer(rig, test::room_map(drive.room()), {});
  PoseEstimate estimate;
  std::optional<Alert> named;
  for (std::size_t i = 0; i < drive.size() && !named; ++i) {
    localizer.localize(drive.set(i), estimate);
    EXPECT_NE(estimate.status, PoseStatus::ok);
    for (const Alert& alert : localizer.alerts()) named = alert;
  }
  ASSERT_TRUE(named);
  EXPECT_EQ(named->kind, AlertKind::cameras_swapped);
  EXPECT_EQ(named->camera, 0);
  EXPECT_EQ(named->other_camera, 2);
}

TEST(Localizer, AFrozenCameraIsLeftOutAndSaid) {
  RoomDrive drive(test::make_room(usual(1)));
  Localizer localizer(drive.room().rig, test::room_map(drive.room()), {});
  const CameraParameters& size = drive.room().rig.cameras[0].model.parameters();
  GrayImage image(size.width_px, size.height_px);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<std::uint8_t>((i / 64 + i / 4000) % 2 == 0 ? 40 : 200);
  }
  PoseEstimate estimate;
  for (int i = 0; i < 3; ++i) {
    FrameSetLease set;
    set.expected = 7;
    set.cameras = camera_bit(0);
    FrameInfo info;
    info.stamp = test::room_stamp(i);
    set.frames[0] = Frame(info, image.view(), nullptr, nullptr, 0);
    localizer.localize(set, estimate);
    EXPECT_EQ(localizer.unhealthy_cameras(), i == 2 ? camera_bit(0) : 0U);
  }
  ASSERT_EQ(localizer.alerts().size(), 1U);
  EXPECT_EQ(localizer.alerts()[0].kind, AlertKind::image_frozen);
}

class ManyDetections : public testing::TestWithParam<int> {};

/// One camera sees hundreds of small things that pass for markers.
TEST_P(ManyDetections, OfMoreThanAreUsedTheLargestInTheImageAre) {
  RoomDrive drive(test::make_room(usual(3)));
  Localizer localizer(drive.room().rig, test::room_map(drive.room()), {});
  PoseEstimate alone;
  localizer.localize(drive.set(0), alone);
  ASSERT_EQ(alone.status, PoseStatus::ok);

  FrameSetLease set = drive.set(0);
  const auto crowded = static_cast<std::size_t>(GetParam());
  ImageDetections crowd = *set.frames[crowded].detections();
  for (int i = 0; i < 700; ++i) {
    Detection& detection = crowd.detections.emplace_back();
    detection.marker = {Family::tag36h11, 100 + i % 450};
    const Eigen::Vector2d at(5 + 1.7 * i, 5 + (i * 37) % 900);
    detection.corners = {at, at + Eigen::Vector2d(3, 0), at + Eigen::Vector2d(3, 3),
                         at + Eigen::Vector2d(0, 3)};
  }
  set.frames[crowded] = Frame(set.frames[crowded].info(), {}, &crowd, nullptr, 0);
  Localizer crowded_localizer(drive.room().rig, test::room_map(drive.room()), {});
  PoseEstimate estimate;
  crowded_localizer.localize(set, estimate);
  EXPECT_EQ(estimate.observations.size(), kMaxObservations);
  EXPECT_EQ(estimate.status, PoseStatus::ok);
  EXPECT_EQ(estimate.cameras_used, alone.cameras_used);
  EXPECT_EQ(estimate.observations_used, alone.observations_used);
  EXPECT_TRUE(std::is_sorted(estimate.observations.begin(), estimate.observations.end(),
                             [](const auto& a, const auto& b) { return a.camera < b.camera; }));
}

INSTANTIATE_TEST_SUITE_P(Localizer, ManyDetections, testing::Values(0, 1, 2));

TEST(Localizer, AfterTheMachineSleptAnyPlaceMayBeNext) {
  RoomDrive drive(test::make_room(usual(60)));
  for (const bool slept : {false, true}) {
    Localizer localizer(drive.room().rig, test::room_map(drive.room()), {});
    PoseEstimate estimate;
    for (std::size_t i = 0; i < 5; ++i) localizer.localize(drive.set(i), estimate);
    if (slept) localizer.forget_motion();
    // Towed across the room meanwhile; CLOCK_MONOTONIC stood still.
    FrameSetLease set = drive.set(35);
    for (std::size_t c = 0; c < drive.room().rig.cameras.size(); ++c) {
      FrameInfo info = set.frames[c].info();
      info.stamp = test::room_stamp(5);
      set.frames[c] = Frame(info, {}, set.frames[c].detections(), nullptr, 0);
    }
    localizer.localize(set, estimate);
    EXPECT_EQ(estimate.has(PoseReason::jump), !slept);
    EXPECT_EQ(estimate.status, slept ? PoseStatus::ok : PoseStatus::degraded);
  }
}

TEST(Localizer, DetectionsThatWereGivenBeforeNeverMakeAnOkPose) {
  RoomDrive drive(test::make_room(usual(60)));
  Localizer localizer(drive.room().rig, test::room_map(drive.room()), {});
  PoseEstimate estimate;
  std::vector<Alert> alerts;
  for (int i = 0; i < 40; ++i) {
    const bool stale = i >= 10;
    FrameSetLease set =
        drive.set(stale ? static_cast<std::size_t>(8 + i % 2) : static_cast<std::size_t>(i));
    for (std::size_t c = 0; c < drive.room().rig.cameras.size(); ++c) {
      FrameInfo info = set.frames[c].info();
      info.stamp = test::room_stamp(i);
      set.frames[c] = Frame(info, {}, set.frames[c].detections(), nullptr, 0);
    }
    localizer.localize(set, estimate);
    EXPECT_EQ(estimate.status, stale ? PoseStatus::lost : PoseStatus::ok) << i;
    for (const Alert& alert : localizer.alerts()) alerts.push_back(alert);
  }
  ASSERT_EQ(alerts.size(), 3U) << "one of each camera";
  for (const Alert& alert : alerts) EXPECT_EQ(alert.kind, AlertKind::image_stale);
  EXPECT_EQ(localizer.unhealthy_cameras(), 7U);
}

TEST(Localizer, WhatWasGivenBeforeAReloadMakesNoPoseAfterIt) {
  RoomDrive drive(test::make_room(usual(60)));
  const MarkerMap map = test::room_map(drive.room());
  Localizer before(drive.room().rig, map, {});
  PoseEstimate estimate;
  for (std::size_t i = 0; i < 10; ++i) before.localize(drive.set(i), estimate);
  ASSERT_EQ(estimate.status, PoseStatus::ok);
  Localizer after(drive.room().rig, map, {});
  after.remember_images_of(before);
  after.localize(drive.set(9), estimate);
  EXPECT_EQ(estimate.status, PoseStatus::lost) << "the same detections";
  after.localize(drive.set(10), estimate);
  EXPECT_NE(estimate.status, PoseStatus::lost) << "new ones";
}

TEST(Localizer, WhatAFrozenCameraGivesFirstAfterARestartMakesNoPose) {
  RoomDrive drive(test::make_room(usual(60)));
  const MarkerMap map = test::room_map(drive.room());
  LocalizerOptions options;
  options.doubt_first_images = true;
  Localizer localizer(drive.room().rig, map, options);
  PoseEstimate estimate;
  const auto status_of = [&](std::size_t set) {
    localizer.localize(drive.set(set), estimate);
    return estimate.status;
  };
  EXPECT_EQ(status_of(9), PoseStatus::lost) << "may be of before";
  EXPECT_EQ(status_of(9), PoseStatus::lost) << "is of before";
  EXPECT_NE(status_of(10), PoseStatus::lost);
}

TEST(Localizer, ImagesThatTheLibraryFailsOnAreLeftOutCountedAndSaid) {
  RoomDrive drive(test::make_room(usual(60)));
  Localizer localizer(drive.room().rig, test::room_map(drive.room()), {});
  const CameraParameters& size = drive.room().rig.cameras[1].model.parameters();
  GrayImage image(size.width_px, size.height_px, 0);
  PoseEstimate estimate;
  std::vector<Alert> alerts;
  for (std::size_t i = 0; i < 12; ++i) {
    const bool fails = i >= 3 && i < 9;
    FrameSetLease set = drive.set(i);
    if (fails) {
      for (std::size_t p = 0; p < image.pixels.size(); ++p) {
        image.pixels[p] = static_cast<std::uint8_t>((p * 7919 + i * 101) % 251);
      }
      GrayView torn = image.view();
      torn.stride_bytes = 1;  // rows that overlap, at which OpenCV refuses to look
      set.frames[1] = Frame(set.frames[1].info(), torn, nullptr, nullptr, 0);
    }
    localizer.localize(set, estimate);
    EXPECT_EQ(localizer.left_out(DropReason::unsearched), fails ? 0b10U : 0U) << i;
    EXPECT_EQ(localizer.left_out(DropReason::unhealthy), 0U) << i;
    EXPECT_EQ(estimate.has(PoseReason::camera_missing), fails) << i;
    EXPECT_TRUE(estimate.has_pose());
    for (const Alert& alert : localizer.alerts()) alerts.push_back(alert);
  }
  ASSERT_EQ(alerts.size(), 1U);
  EXPECT_EQ(alerts[0].kind, AlertKind::image_unsearched);
  EXPECT_EQ(alerts[0].camera, 1);
}

TEST(Localizer, AnIgnoredMarkerTakesNoPartMovedUnknownOrNot) {
  RoomDrive drive(test::make_room(usual(60)));
  MarkerMap map = test::room_map(drive.room());
  map.submaps[0].markers[5].world_from_marker.translation += Eigen::Vector3d(0.06, 0.05, 0.0);
  const MarkerId moved = map.submaps[0].markers[5].id;
  const MarkerId unknown = map.submaps[0].markers[7].id;
  map.submaps[0].markers.erase(map.submaps[0].markers.begin() + 7);
  std::array ignored = {moved, unknown};
  std::sort(ignored.begin(), ignored.end());
  Localizer localizer(drive.room().rig, map, {});
  localizer.ignore(ignored);
  PoseEstimate estimate;
  int seen_ignored = 0;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    localizer.localize(drive.set(i), estimate);
    EXPECT_TRUE(localizer.alerts().empty()) << i;
    for (const ObservedMarker& seen : estimate.observations) {
      const bool is_ignored = seen.marker == moved || seen.marker == unknown;
      EXPECT_EQ(seen.verdict == ObservationVerdict::ignored, is_ignored);
      seen_ignored += is_ignored ? 1 : 0;
    }
  }
  EXPECT_GT(seen_ignored, 0);
  EXPECT_FALSE(localizer.quarantine_changed());
  localizer.ignore({});
  localizer.localize(drive.set(0), estimate);
  for (const ObservedMarker& seen : estimate.observations) {
    EXPECT_NE(seen.verdict, ObservationVerdict::ignored);
  }
}

TEST(Localizer, AReleasedMarkerIsUsedWithTheNextSet) {
  RoomDrive drive(test::make_room(usual(4)));
  const MarkerMap map = test::room_map(drive.room());
  Localizer localizer(drive.room().rig, map, {});
  const QuarantinedMarker was{map.submaps[0].markers[5].id, QuarantineState::moved, 0, 0.1};
  localizer.restore_quarantine(std::span(&was, 1));
  PoseEstimate estimate;
  localizer.localize(drive.set(0), estimate);
  EXPECT_TRUE(localizer.alerts().empty());
  localizer.release(was.marker);
  localizer.localize(drive.set(1), estimate);
  ASSERT_EQ(localizer.alerts().size(), 1U);
  EXPECT_FALSE(localizer.alerts()[0].raised);
  EXPECT_EQ(localizer.alerts()[0].marker, was.marker);
  EXPECT_TRUE(quarantine_of(localizer).empty());
  for (const ObservedMarker& seen : estimate.observations) {
    EXPECT_NE(seen.verdict, ObservationVerdict::quarantined);
  }
  localizer.release(was.marker);  // it is not in quarantine
  localizer.localize(drive.set(2), estimate);
  EXPECT_TRUE(localizer.alerts().empty());
}

}  // namespace
}  // namespace waymark
