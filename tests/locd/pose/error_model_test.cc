// Verdicts, from detections to alerts; the table of attacks is in tests/bench/locd_attacks.
#include "locd/pose/error_model.h"

#include <gtest/gtest.h>

#include "tests/locd/pose/room_drive.h"
#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

test::RoomOptions usual(int sets) {
  test::RoomOptions options;
  options.frame_sets = sets;
  options.noise_px = 0.1;
  options.state_covariances = true;
  options.markers = 60;
  return options;
}

/// The rig as a user has it: sigmas are not stated.
Rig unstated(Rig rig) {
  for (RigCamera& camera : rig.cameras) camera.stated_sigmas = {};
  return rig;
}

/// Drives one round and gathers what was said.
std::vector<Alert> drive(const test::RoomDrive& drive, const Rig& told, int& ok) {
  Localizer localizer(told, test::room_map(const_cast<test::RoomDrive&>(drive).room()), {});
  PoseEstimate estimate;
  std::vector<Alert> alerts;
  ok = 0;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    localizer.localize(drive.set(i), estimate);
    ok += estimate.status == PoseStatus::ok ? 1 : 0;
    for (const Alert& alert : localizer.alerts()) alerts.push_back(alert);
  }
  return alerts;
}

TEST(ErrorModel, NamesNobodyForWhatACalibrationMayBeOffBy) {
  test::RoomDrive room(test::make_room(usual(200)));
  Rig told = unstated(room.room().rig);
  for (std::size_t c = 1; c < told.cameras.size(); ++c) {
    told.cameras[c].rig_from_cam.rotation =
        told.cameras[c].rig_from_cam.rotation * so3_exp({0.001, -0.0008, 0.0009});
    told.cameras[c].rig_from_cam.translation += Eigen::Vector3d(0.001, -0.001, 0.001);
  }
  int ok = 0;
  EXPECT_TRUE(drive(room, told, ok).empty());
  EXPECT_GT(ok, 190);
}

TEST(ErrorModel, NamesALensWithItsFocalLength) {
  test::RoomDrive room(test::make_room(usual(200)));
  Rig told = unstated(room.room().rig);
  CameraParameters p = told.cameras[1].model.parameters();
  p.fu_px /= 1.02;
  p.fv_px /= 1.02;
  told.cameras[1].model = *CameraModel::create(p);
  int ok = 0;
  const auto alerts = drive(room, told, ok);
  ASSERT_EQ(alerts.size(), 1U);
  EXPECT_EQ(alerts[0].kind, AlertKind::lens_off);
  EXPECT_EQ(alerts[0].camera, 1);
  EXPECT_NEAR(alerts[0].value, 0.02, 0.003);
}

TEST(ErrorModelOptions, AreHeldToTheirRanges) {
  using Options = ErrorModelOptions;
  expect_ranges<Options>({ranged("gain", &Options::gain, {5, 100}),
                          ranged("lead", &Options::lead, {2, 50}),
                          ranged("over_gain", &Options::over_gain, {-20, 0}),
                          ranged("chi2", &Options::chi2, {20, 500}),
                          ranged("marker_m", &Options::marker_m, {0.001, 1}),
                          ranged("marker_rad", &Options::marker_rad, {0.002, 0.5}),
                          ranged("camera_m", &Options::camera_m, {0.001, 1}),
                          ranged("camera_rad", &Options::camera_rad, {0.001, 0.2}),
                          ranged("sets_per_look", &Options::sets_per_look, {1, 100}),
                          ranged("fewest_views", &Options::fewest_views, {2, 100})});
}

}  // namespace
}  // namespace waymark
