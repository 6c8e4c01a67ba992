#include "core/camera/kalibr_sigmas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "core/camera/kalibr.h"
#include "core/camera/rig_parameters.h"

namespace waymark {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kRadPerDeg = std::numbers::pi / 180;

std::string camera(const std::string& name, const std::string& more,
                   const std::string& lens = "radtan") {
  return name +
         ":\n  camera_model: pinhole\n  intrinsics: [500, 500, 320, 240]\n  distortion_model: " +
         lens + "\n  distortion_coeffs: [0, 0, 0, 0]\n  resolution: [640, 480]\n" + more;
}

const std::string kPlace =
    "  T_cn_cnm1: [[1, 0, 0, 0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";

Rig parsed(const std::string& text) {
  auto loaded = parse_camchain(text, "rig.yaml");
  EXPECT_TRUE(loaded) << loaded.error().message;
  return loaded ? loaded->rig : Rig();
}

std::string message_of(const std::string& text) {
  const auto loaded = parse_camchain(text, "rig.yaml");
  if (loaded) return "no error";
  EXPECT_EQ(loaded.error().kind, ErrorKind::bad_data);
  EXPECT_EQ(loaded.error().message.find('\n'), std::string::npos);
  return loaded.error().message;
}

/// The lower triangle of a unit matrix with `corner` in its first place.
std::string triangle(std::size_t size, const std::string& corner) {
  std::string text = "  sigma_joint: [" + corner;
  for (std::size_t row = 1; row < size; ++row) {
    for (std::size_t column = 0; column <= row; ++column) text += row == column ? ", 1" : ", 0";
  }
  return text + "]\n";
}

TEST(KalibrSigmas, AnySubsetIsRead) {
  const Rig rig = parsed(camera("cam0", "  sigma: {focal: 0.002, edge_px: 0.1, stamp_us: 20}\n") +
                         camera("cam1", kPlace + "  sigma: {position_m: 0.003, rotation_deg: 0.2}\n"
                                                 "  sigma_source: hand\n"));
  const StatedSigmas& first = rig.cameras[0].stated_sigmas;
  EXPECT_EQ(first.focal, 0.002);
  EXPECT_EQ(first.edge_px, 0.1);
  EXPECT_DOUBLE_EQ(*first.stamp_s, 2e-5);
  EXPECT_EQ(first.k1, std::nullopt);
  EXPECT_EQ(rig.cameras[0].sigma_source, std::nullopt);
  EXPECT_EQ(rig.cameras[1].stated_sigmas.position_m, 0.003);
  EXPECT_DOUBLE_EQ(*rig.cameras[1].stated_sigmas.rotation_rad, 0.2 * kRadPerDeg);
  EXPECT_EQ(rig.cameras[1].sigma_source, SigmaSource::hand);
}

TEST(KalibrSigmas, ReadBackAsWritten) {
  const std::string text =
      camera("cam0", "  sigma: {focal: 0.002, principal_px: 1}\n" + triangle(7 + 13, "4e-06")) +
      camera("cam1", kPlace + "  sigma_source: refined\n");
  const Rig rig = parsed(text);
  ASSERT_TRUE(rig.joint_sigmas);
  EXPECT_DOUBLE_EQ((*rig.joint_sigmas)(0, 0), 4e-6);
  EXPECT_DOUBLE_EQ((*rig.joint_sigmas)(5, 5), 1e-12) << "stamps are in µs";
  EXPECT_DOUBLE_EQ((*rig.joint_sigmas)(10, 10), kRadPerDeg * kRadPerDeg);
  const Rig again = parsed(format_camchain(rig));
  EXPECT_TRUE(again.joint_sigmas->isApprox(*rig.joint_sigmas, 1e-14));
  EXPECT_EQ(again.cameras[0].stated_sigmas, rig.cameras[0].stated_sigmas);
  EXPECT_EQ(again.cameras[1].sigma_source, SigmaSource::refined);
}

TEST(KalibrSigmas, OnlyPositiveNumbersInReason) {
  for (const std::string bad : {"-0.001", "0", "2"}) {
    EXPECT_THAT(message_of(camera("cam0", "  sigma: {focal: " + bad + "}\n")),
                AllOf(HasSubstr("rig.yaml: line 7: cam0: sigma: focal: "),
                      HasSubstr("is not above 0 and at most 1")))
        << bad;
  }
  EXPECT_THAT(message_of(camera("cam0", "  sigma: {focal: .nan}\n")),
              HasSubstr("sigma: focal: is not finite"));
  EXPECT_THAT(message_of(camera("cam0", "  sigma: {focal: much}\n")),
              HasSubstr("sigma: focal: is no number"));
  EXPECT_THAT(message_of(camera("cam0", "  sigma: {fokal: 1}\n")),
              HasSubstr("sigma: fokal: is not one of position_m, rotation_deg, focal"));
  EXPECT_THAT(message_of(camera("cam0", "  sigma: {k1: 1, k1: 1}\n")),
              HasSubstr("stands there twice"));
  EXPECT_THAT(message_of(camera("cam0", "  sigma: 0.001\n")), HasSubstr("sigma: is no map"));
  EXPECT_THAT(message_of(camera("cam0", "  sigma_source: me\n")),
              HasSubstr("sigma_source: is not one of kalibr, opencv, hand, refined"));
}

TEST(KalibrSigmas, OnlyOfWhatTheModelHas) {
  EXPECT_THAT(message_of(camera("cam0", "  sigma: {position_m: 0.001}\n")),
              HasSubstr("cam0: sigma: position_m: the model lacks it: the camera is the rig's"));
  EXPECT_THAT(message_of(camera("cam0", "  sigma: {k1: 0.001}\n", "none")),
              HasSubstr("cam0: sigma: k1: the model lacks it"));
  EXPECT_THAT(message_of(camera("cam0", "  global_shutter: true\n  sigma: {readout_us: 100}\n")),
              HasSubstr("cam0: sigma: readout_us: the model lacks it"));
}

TEST(KalibrSigmas, JointOnesFitTheirRig) {
  EXPECT_EQ(message_of(camera("cam0", triangle(7, "1"))), "no error");
  EXPECT_THAT(message_of(camera("cam0", triangle(6, "1"))),
              HasSubstr("sigma_joint: 21 numbers instead of 28, the lower triangle of 7 "
                        "parameters: it is of another rig"));
  EXPECT_THAT(message_of(camera("cam0", triangle(7, "-1"))), HasSubstr("not positive definite"));
  EXPECT_THAT(message_of(camera("cam0", triangle(7, "0"))), HasSubstr("not positive definite"));
  EXPECT_THAT(message_of(camera("cam0", triangle(7, ".nan"))), HasSubstr("is not finite"));
  EXPECT_THAT(message_of(camera("cam0", "  sigma: {focal: 0.5}\n" + triangle(7, "1"))),
              HasSubstr("cam0: sigma: focal is 0.5, sigma_joint says 1: it is of another rig"));
  EXPECT_THAT(message_of(camera("cam0", "") + camera("cam1", kPlace + triangle(20, "1"))),
              HasSubstr("cam1: sigma_joint: stands at cam0"));
  EXPECT_THAT(message_of(camera("cam0", "  sigma_joint: 3\n")), HasSubstr("is no list"));
}

TEST(KalibrSigmas, AForeignCalibrationIsOpenCvs) {
  const Rig rig = parsed(
      "image_width: 640\nimage_height: 480\ncamera_matrix: {data: [500, 0, 320, 0, 500, 240, 0, 0, "
      "1]}\ndistortion_coefficients: {data: [0.1, 0, 0, 0]}\n");
  ASSERT_EQ(rig.cameras.size(), 1U);
  EXPECT_EQ(rig.cameras[0].sigma_source, SigmaSource::opencv);
  EXPECT_EQ(sigmas_of(rig.cameras[0]).principal_px, 1.5);
}

}  // namespace
}  // namespace waymark
