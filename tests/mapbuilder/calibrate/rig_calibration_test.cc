#include "mapbuilder/calibrate/rig_calibration.h"

#include <cmath>

#include "tests/mapbuilder/calibrate/unknown_room.h"

namespace waymark {
namespace {

Expected<RigCalibration> calibrated(const std::vector<DetectedCapture>& captures) {
  Progress progress(false);
  const auto found = find_rig(captures, {}, progress);
  if (!found) return tl::make_unexpected(found.error());
  return calibrate_rig(captures, *found, {}, progress);
}

bool names(const RigCalibration& calibration, const std::string& text) {
  return std::any_of(calibration.findings.begin(), calibration.findings.end(),
                     [&](const Finding& one) { return one.text.find(text) != std::string::npos; });
}

class CalibratedRig : public testing::TestWithParam<int> {};

TEST_P(CalibratedRig, IsTheTrueOneToWithinItsSigmas) {
  const auto room = test::noisy_room(GetParam());
  const auto calibration = calibrated({test::capture_of_unknown_rig(room)});
  ASSERT_TRUE(calibration) << calibration.error().message;
  const Rigid3 first_from_rig = room.rig.cameras[0].rig_from_cam.inverse();
  for (std::size_t k = 0; k < room.rig.cameras.size(); ++k) {
    const RigCamera& camera = calibration->rig.cameras[k];
    const CameraParameters& p = camera.model.parameters();
    const StatedSigmas& sigmas = camera.stated_sigmas;
    ASSERT_TRUE(sigmas.focal) << k;
    EXPECT_LT(std::abs(p.fu_px / 640 - 1), 5 * *sigmas.focal + 1e-5) << k;
    EXPECT_LT(*sigmas.focal, 0.003) << k;
    EXPECT_LT(std::abs(p.pu_px - 639.5), 5 * *sigmas.principal_px) << k;
    if (k == 0) continue;
    const Vector6d off =
        camera.rig_from_cam.minus(first_from_rig * room.rig.cameras[k].rig_from_cam);
    EXPECT_LT(off.head<3>().norm(), 5 * std::sqrt(3.0) * *sigmas.position_m) << k;
    EXPECT_LT(off.tail<3>().norm(), 5 * std::sqrt(3.0) * *sigmas.rotation_rad) << k;
    EXPECT_LT(*sigmas.position_m, 0.005) << k;
  }
  EXPECT_NEAR(calibration->quality.joint_px, 0.1, 0.02);
  EXPECT_EQ(calibration->coverage.size(), room.rig.cameras.size());
}

INSTANTIATE_TEST_SUITE_P(OfSoManyCameras, CalibratedRig, testing::Values(1, 2, 3));

TEST(RigCalibration, SaysThatASingleCameraHasNoExtrinsics) {
  const auto calibration = calibrated({test::capture_of_unknown_rig(test::noisy_room(1))});
  ASSERT_TRUE(calibration) << calibration.error().message;
  EXPECT_TRUE(names(*calibration, "it has no extrinsics"));
}

TEST(RigCalibration, KeepsLensesWhereCamerasCanNotBeLinked) {
  auto room = test::noisy_room(2);
  std::erase_if(room.images, [](const ImageDetections& image) {
    const auto number = (image.stamp - test::room_stamp(0)) / std::chrono::milliseconds(100);
    return number % 2 != image.camera;
  });
  const auto calibration = calibrated({test::capture_of_unknown_rig(room)});
  ASSERT_TRUE(calibration) << calibration.error().message;
  EXPECT_FALSE(calibration->rig.has_extrinsics);
  EXPECT_NEAR(calibration->rig.cameras[1].model.parameters().fu_px, 640, 2);
  EXPECT_TRUE(names(*calibration, "has no transforms"));
}

TEST(RigCalibration, OfOneViewIsRefused) {
  const auto calibration = calibrated({test::capture_of_unknown_rig(test::noisy_room(1, 1))});
  ASSERT_FALSE(calibration);
  EXPECT_EQ(calibration.error().kind, ErrorKind::bad_data);
}

TEST(RigCalibration, AnotherRigFitsWorse) {
  const auto room = test::noisy_room(2, 30);
  const std::vector<DetectedCapture> captures{test::capture_of(room)};
  Progress progress(false);
  const auto true_fit = fit_of_rig(captures, room.rig, {}, progress);
  Rig other = room.rig;
  for (RigCamera& camera : other.cameras) {
    CameraParameters p = camera.model.parameters();
    p.fu_px *= 1.05;
    camera.model = *CameraModel::create(p);
  }
  const auto other_fit = fit_of_rig(captures, other, {}, progress);
  ASSERT_TRUE(true_fit && other_fit);
  EXPECT_LT(true_fit->joint_px, other_fit->joint_px);
}

}  // namespace
}  // namespace waymark
