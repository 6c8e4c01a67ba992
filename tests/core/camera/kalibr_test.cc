#include "core/camera/kalibr.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

const std::string kLens =
    "  camera_model: pinhole\n"
    "  intrinsics: [470.3, 470.5, 639.7, 524.4]\n"
    "  distortion_model: equidistant\n"
    "  distortion_coeffs: [-0.013211, -0.00988947, 0.0121051, -0.00452971]\n"
    "  resolution: [1280, 1024]\n"
    "  rostopic: /cam/image_raw\n";

/// Camera turned by +90° about the previous one's y, 0.1 m along its x.
const std::string kTurned =
    "  - [0, 0, 1, 0.1]\n"
    "  - [0, 1, 0, 0]\n"
    "  - [-1, 0, 0, 0]\n"
    "  - [0, 0, 0, 1]\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string chain() {
  return "cam0:\n" + kLens + "cam1:\n" + kLens + "  T_cn_cnm1:\n" + kTurned + "cam2:\n" + kLens +
         "  T_cn_cnm1:\n" + kTurned;
}

std::string message_of(const std::string& text) {
  const auto loaded = parse_camchain(text, "rig.yaml");
  if (loaded) return "no error";
  EXPECT_EQ(loaded.error().kind, ErrorKind::bad_data);
  EXPECT_EQ(loaded.error().message.find('\n'), std::string::npos);
  return loaded.error().message;
}

TEST(Kalibr, FollowsTheChainFromCam0) {
  const auto loaded = parse_camchain(chain(), "rig.yaml");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(loaded->notes, IsEmpty());
  const auto& cameras = loaded->rig.cameras;
  ASSERT_EQ(cameras.size(), 3U);
  EXPECT_TRUE(loaded->rig.has_extrinsics);
  EXPECT_EQ(cameras[1].name, "cam1");
  EXPECT_EQ(cameras[1].model.parameters().distortion, Distortion::equidistant);
  EXPECT_EQ(cameras[1].model.parameters().width_px, 1280);
  EXPECT_EQ(cameras[1].model.parameters().coefficients[3], -0.00452971);
  EXPECT_TRUE(cameras[0].rig_from_cam.translation.isZero(0));
  // x_1 = R x_0 + t, so x_0 = Rᵀ (x_1 − t): the origin of cam1 lies at −Rᵀ t = (0, 0, −0.1).
  EXPECT_TRUE(cameras[1].rig_from_cam.translation.isApprox(Eigen::Vector3d(0, 0, -0.1), 1e-14));
  const Rigid3 cam1_from_cam0 = cameras[1].rig_from_cam.inverse();
  EXPECT_LT(cameras[2].rig_from_cam.inverse().minus(cam1_from_cam0 * cam1_from_cam0).norm(), 1e-14);
}

TEST(Kalibr, TheBodyIsTheRigWhereEveryCameraHasIt) {
  const std::string text = "cam0:\n" + kLens + "  T_cam_imu:\n" + kTurned +
                           "  timeshift_cam_imu: 0.002\n" + "cam1:\n" + kLens + "  T_cam_imu:\n" +
                           kTurned;
  const auto loaded = parse_camchain(text, "rig.yaml");
  ASSERT_TRUE(loaded) << loaded.error().message;
  for (const RigCamera& camera : loaded->rig.cameras) {
    EXPECT_TRUE(camera.rig_from_cam.translation.isApprox(Eigen::Vector3d(0, 0, -0.1), 1e-14));
  }
  EXPECT_EQ(loaded->rig.cameras[0].timeshift_cam_imu_s, 0.002);
  EXPECT_THAT(loaded->notes,
              ElementsAre(AllOf(StartsWith("rig.yaml: line 13: cam0: timeshift_cam_imu"),
                                HasSubstr("0.002 s, not used"))));
}

TEST(Kalibr, BodyAndChainMustAgree) {
  const auto text = [](const std::string& step) {
    return "cam0:\n" + kLens + "  T_cam_imu:\n" + kTurned + "cam1:\n" + kLens + "  T_cam_imu:\n" +
           kTurned + "  T_cn_cnm1: [[1, 0, 0, " + step +
           "], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
  };
  EXPECT_EQ(message_of(text("0.00099")), "no error");
  EXPECT_THAT(message_of(text("0.00101")),
              AllOf(HasSubstr("cam1"), HasSubstr("disagree by 1.01 mm")));
  const std::string turned = replaced(text("0"), "[[1, 0, 0, 0], [0, 1, 0, 0]",
                                      "[[1, -0.00192, 0, 0], [0.00192, 1, 0, 0]");
  EXPECT_THAT(message_of(turned), HasSubstr("0.110°"));
}

TEST(Kalibr, TransformsAreForAllOrNone) {
  const std::string some_chain =
      "cam0:\n" + kLens + "cam1:\n" + kLens + "cam2:\n" + kLens + "  T_cn_cnm1:\n" + kTurned;
  EXPECT_THAT(message_of(some_chain), HasSubstr("cam1: T_cn_cnm1 is missing"));
  const std::string some_body = "cam0:\n" + kLens + "  T_cam_imu:\n" + kTurned + "cam1:\n" + kLens +
                                "  T_cn_cnm1:\n" + kTurned;
  EXPECT_THAT(message_of(some_body), HasSubstr("cam1: T_cam_imu is missing"));
  const auto none = parse_camchain("cam0:\n" + kLens + "cam1:\n" + kLens, "rig.yaml");
  ASSERT_TRUE(none);
  EXPECT_FALSE(none->rig.has_extrinsics);
  const auto single = parse_camchain("cam0:\n" + kLens, "rig.yaml");
  ASSERT_TRUE(single);
  EXPECT_TRUE(single->rig.has_extrinsics);
  EXPECT_THAT(message_of("cam0:\n" + kLens + "  T_cn_cnm1:\n" + kTurned),
              HasSubstr("cam0: T_cn_cnm1 has no meaning"));
}

TEST(Kalibr, NearRotationsAreProjectedWithANote) {
  // R = diag(1 + e, 1, 1) gives |RᵀR − I| = 2e + e².
  const auto text = [](const std::string& one) {
    return "cam0:\n" + kLens + "cam1:\n" + kLens + "  T_cn_cnm1: [[" + one +
           ", 0, 0, 0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
  };
  const auto near = parse_camchain(text("1.00049"), "rig.yaml");
  ASSERT_TRUE(near) << near.error().message;
  EXPECT_THAT(near->notes,
              ElementsAre(HasSubstr("line 15: cam1: T_cn_cnm1: rotation is off by 0.00098")));
  EXPECT_LT(so3_log(near->rig.cameras[1].rig_from_cam.rotation).norm(), 1e-15);
  EXPECT_THAT(message_of(text("1.00051")),
              HasSubstr("rig.yaml: line 15: cam1: T_cn_cnm1: is no rotation"));
  EXPECT_THAT(message_of(text("-1")), HasSubstr("is no rotation"));
}

TEST(Kalibr, ExtrasAreRead) {
  const auto loaded =
      parse_camchain("cam0:\n" + kLens +
                         "  serial: '00417'\n  lens_id: C-mount 6\n  readout_us: 15000\n"
                         "  global_shutter: false\n  edge_bias_px: 0.27\n  response: srgb\n",
                     "rig.yaml");
  ASSERT_TRUE(loaded) << loaded.error().message;
  const RigCamera& camera = loaded->rig.cameras[0];
  EXPECT_EQ(camera.serial, "00417");
  EXPECT_EQ(camera.lens_id, "C-mount 6");
  EXPECT_EQ(camera.readout_us, 15000);
  EXPECT_EQ(camera.global_shutter, false);
  EXPECT_FALSE(camera.timeshift_cam_imu_s);
  EXPECT_EQ(camera.edge_bias_px, 0.27);
  EXPECT_EQ(camera.response, SensorResponse::srgb);
}

TEST(Kalibr, AResponseOfAutoIsNotStated) {
  const auto loaded = parse_camchain("cam0:\n" + kLens + "  response: auto\n", "rig.yaml");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_FALSE(loaded->rig.cameras[0].response);
  EXPECT_FALSE(loaded->rig.cameras[0].edge_bias_px);
}

TEST(Kalibr, NoneNeedsNoCoefficients) {
  for (const auto* coefficients :
       {"", "  distortion_coeffs: []\n", "  distortion_coeffs: [0, 0, 0, 0]\n"}) {
    const std::string text =
        std::string(
            "cam0:\n  camera_model: pinhole\n  intrinsics: [500, 500, 320, 240]\n"
            "  distortion_model: none\n  resolution: [640, 480]\n") +
        coefficients;
    const auto loaded = parse_camchain(text, "rig.yaml");
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->rig.cameras[0].model.parameters().distortion, Distortion::none);
  }
}

TEST(Kalibr, UnknownKeysAreNotedMisspeltTransformsRefused) {
  const auto loaded =
      parse_camchain("cam0:\n" + kLens + "  line_delay: 0\nnotes: hello\n", "rig.yaml");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(loaded->notes, ElementsAre(HasSubstr("'notes'"), HasSubstr("cam0: line_delay")));
  EXPECT_THAT(message_of("cam0:\n" + kLens + "cam1:\n" + kLens + "  T_cn_cnml:\n" + kTurned),
              HasSubstr("rig.yaml: line 15: cam1: T_cn_cnml: unknown transform"));
}

struct BadText {
  std::string from;
  std::string to;
  std::string message;
};

std::ostream& operator<<(std::ostream& out, const BadText& bad) {
  return out << bad.from << " -> " << bad.to;
}

class BadCamchain : public ::testing::TestWithParam<BadText> {};

TEST_P(BadCamchain, IsRefusedWithPlaceAndReason) {
  EXPECT_THAT(message_of(replaced(chain(), GetParam().from, GetParam().to)),
              AllOf(StartsWith("rig.yaml: "), HasSubstr(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    Kalibr, BadCamchain,
    ::testing::Values(
        BadText{"pinhole", "omni", "line 2: cam0: camera_model: 'omni'"},
        BadText{"  camera_model: pinhole\n", "", "cam0: camera_model: is missing"},
        BadText{"equidistant", "fov", "line 4: cam0: distortion_model: 'fov'"},
        BadText{"equidistant", "none", "although distortion_model is none"},
        BadText{"[-0.013211, ", "[", "distortion_coeffs: a list of 3 instead of a list of 4"},
        BadText{"[470.3, ", "[0.1, 470.3, ", "intrinsics: a list of 5"},
        BadText{"[470.3, 470.5, 639.7, 524.4]", "470", "intrinsics: something else"},
        BadText{"470.3", ".nan", "line 3: cam0: intrinsics: is not finite"},
        BadText{"470.3", ".inf", "is not finite"}, BadText{"470.3", "wide", "is no number"},
        BadText{"470.3", "-470.3", "focal lengths"},
        BadText{"[1280, 1024]", "[1280.5, 1024]", "resolution: width 1280.5"},
        BadText{"[1280, 1024]", "[1280, 0]", "resolution: height 0"},
        BadText{"[1280, 1024]", "[1280]", "a list of 1"},
        BadText{"-0.013211", "-3", "another lens"},
        BadText{"0.1]", ".nan]", "T_cn_cnm1: is not finite"},
        BadText{"0.1]", "100.1]", "must be in metres; is it in millimetres?"},
        BadText{"[470.3, 470.5, 639.7, 524.4]", "[639.7, 524.4, 470.3, 1020.5]",
                "at or beyond the rim of 1280×1024: are they written as cx cy fx fy?"},
        BadText{"T_cn_cnm1", "T_imu_cam", "T_imu_cam: is the other way round"},
        BadText{"[-0.013211, ", "[0.1, -0.013211, ",
                "a list of 5 instead of a list of 4 numbers (k1 k2 k3 k4)"},
        BadText{"equidistant", "rational",
                "a list of 4 instead of a list of 8 numbers (k1 k2 p1 p2 k3 k4 k5 k6)"},
        BadText{"pinhole", "eucm",
                "cam0: distortion_model: 'equidistant' is not one of none of camera_model eucm"},
        BadText{"  rostopic: /cam/image_raw\n", "  valid_radius_px: 0\n",
                "valid_radius_px: 0 is not above 0 px"},
        BadText{"  rostopic: /cam/image_raw\n", "  valid_radius_px: .nan\n", "is not finite"},
        BadText{"[0, 0, 0, 1]", "[0, 0, 0, 2]", "last row"},
        BadText{"  - [0, 0, 0, 1]\n", "", "4 rows"},
        BadText{"[0, 1, 0, 0]", "[0, 1, 0]", "a list of 3"},
        BadText{"[0, 1, 0, 0]", "[0, 1.1, 0, 0]", "no rotation"},
        BadText{"cam2", "cam3", "cam3 without a cam2"},
        BadText{"cam2", "cam1", "cam1 stands there twice"},
        BadText{"cam2", "cam02", "'cam02' is no camera name"},
        BadText{"cam2", "camera2", "'camera2' is no camera name"},
        BadText{"  rostopic: /cam/image_raw\n", "  resolution: [1, 1]\n", "stands there twice"},
        BadText{"  rostopic: /cam/image_raw\n", "  readout_us: -1\n", "readout_us"},
        BadText{"  rostopic: /cam/image_raw\n", "  edge_bias_px: 3.1\n",
                "edge_bias_px: is not within -3 and 3 px"},
        BadText{"  rostopic: /cam/image_raw\n", "  edge_bias_px: .nan\n", "is not finite"},
        BadText{"  rostopic: /cam/image_raw\n", "  response: gamma\n",
                "is not one of auto, linear, srgb"},
        BadText{"  rostopic: /cam/image_raw\n", "  response: [srgb]\n",
                "is not one of auto, linear, srgb"},
        BadText{"  rostopic: /cam/image_raw\n", "  global_shutter: 3\n", "neither true nor false"},
        BadText{"  rostopic: /cam/image_raw\n", "  serial: [1]\n", "is no text"},
        BadText{"[470.3", "[[470.3", "not valid YAML"}));

TEST(Kalibr, WhatIsNoCamchainIsRefused) {
  for (const auto* text : {"", "\n", "cam0", "[1, 2]", "cam1: {}", "cam0: 3", "notes: 1",
                           "cam0:\n\t- a", "\x01\x02\x03", "cam0: *nothing", "? [a]\n: b\n"}) {
    EXPECT_THAT(message_of(text), StartsWith("rig.yaml: ")) << text;
  }
}

TEST(Kalibr, EveryTruncationIsRefusedOrRead) {
  const std::string text = chain();
  for (std::size_t length = 0; length < text.size(); ++length) {
    const auto loaded = parse_camchain(text.substr(0, length), "rig.yaml");
    if (!loaded) {
      EXPECT_THAT(loaded.error().message, StartsWith("rig.yaml: "));
    }
  }
}

/// A rig of `cameras`, each of that resolution.
std::string sized(int cameras, const std::string& resolution) {
  std::string text;
  for (int i = 0; i < cameras; ++i) {
    text += fmt::format(
        "cam{}:\n  camera_model: pinhole\n  intrinsics: [5e4, 5e4, 10, 10]\n"
        "  distortion_model: none\n  resolution: [{}]\n",
        i, resolution);
    if (i > 0) text += "  T_cn_cnm1:\n" + kTurned;
  }
  return text;
}

TEST(Kalibr, ImagesOfMoreThanTwoHundredMegapixelsInAllAreRefused) {
  EXPECT_EQ(message_of(sized(1, "20000, 10000")), "no error");
  EXPECT_THAT(message_of(sized(1, "20001, 10000")), HasSubstr("200 megapixels in all"));
  EXPECT_THAT(message_of(sized(1, "100000, 100000")),
              AllOf(StartsWith("rig.yaml: "), HasSubstr("100000×100000")));
  EXPECT_EQ(message_of(sized(1, "100000, 2000")), "no error");
  EXPECT_THAT(message_of(sized(1, "100001, 10")), HasSubstr("resolution"));
  EXPECT_EQ(message_of(sized(5, "8000, 5000")), "no error");
  EXPECT_THAT(message_of(sized(6, "8000, 5000")), StartsWith("rig.yaml: cam5: "));
}

TEST(Kalibr, DepthAndSizeAreBounded) {
  for (const char* level : {"[", "{a: ", "- ", "? ", "&a [", "!!seq ["}) {
    for (const std::size_t levels : {1'000, 150'000, 1'000'000}) {
      std::string text = "cam0: ";
      for (std::size_t i = 0; i < levels; ++i) text += level;
      EXPECT_THAT(message_of(text), StartsWith("rig.yaml: ")) << level << " " << levels;
    }
  }
  const auto nested = [](std::size_t levels) {
    return chain() + "  further: " + std::string(levels, '[') + std::string(levels, ']') + "\n";
  };
  EXPECT_EQ(message_of(nested(400)), "no error");
  EXPECT_THAT(message_of(nested(600)), StartsWith("rig.yaml: "));
  std::string steps;
  for (int i = 0; i < 1'400; ++i) steps += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  EXPECT_THAT(message_of(steps), StartsWith("rig.yaml: "));
  const std::string comment = chain() + "#";
  const std::string most = comment + std::string(kMaxCamchainBytes - comment.size(), ' ');
  EXPECT_EQ(message_of(most), "no error");
  EXPECT_THAT(message_of(most + " "), HasSubstr("larger than 196608 bytes"));
}

TEST(Kalibr, FilesAreReadAndAbsentOnesNoInput) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(read_camchain(folder.write("rig.yaml", "\xEF\xBB\xBF" + chain())));
  const auto absent = read_camchain(folder.path() / "absent.yaml");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().kind, ErrorKind::no_input);
  EXPECT_THAT(absent.error().message, HasSubstr("absent.yaml"));
}

void expect_same(const Rig& a, const Rig& b) {
  ASSERT_EQ(a.cameras.size(), b.cameras.size());
  EXPECT_EQ(a.has_extrinsics, b.has_extrinsics);
  for (std::size_t i = 0; i < a.cameras.size(); ++i) {
    EXPECT_EQ(a.cameras[i].name, b.cameras[i].name);
    EXPECT_EQ(a.cameras[i].model.parameters(), b.cameras[i].model.parameters());
    EXPECT_LT(a.cameras[i].rig_from_cam.minus(b.cameras[i].rig_from_cam).norm(), 1e-14);
    EXPECT_EQ(a.cameras[i].serial, b.cameras[i].serial);
    EXPECT_EQ(a.cameras[i].lens_id, b.cameras[i].lens_id);
    EXPECT_EQ(a.cameras[i].readout_us, b.cameras[i].readout_us);
    EXPECT_EQ(a.cameras[i].global_shutter, b.cameras[i].global_shutter);
    EXPECT_EQ(a.cameras[i].timeshift_cam_imu_s, b.cameras[i].timeshift_cam_imu_s);
    EXPECT_EQ(a.cameras[i].edge_bias_px, b.cameras[i].edge_bias_px);
    EXPECT_EQ(a.cameras[i].response, b.cameras[i].response);
  }
}

TEST(Kalibr, TextReadsBackToTheSameRig) {
  Rig rig = parse_camchain(chain(), "rig.yaml")->rig;
  rig.cameras[1].serial = "a \"quoted\" \\ # name";
  rig.cameras[1].lens_id = "12";
  rig.cameras[2].readout_us = 1.0 / 3;
  rig.cameras[2].global_shutter = true;
  rig.cameras[1].edge_bias_px = -0.1;
  rig.cameras[1].response = SensorResponse::linear;
  rig.cameras[0].timeshift_cam_imu_s = -0.1;
  const auto back = parse_camchain(format_camchain(rig), "again.yaml");
  ASSERT_TRUE(back) << back.error().message;
  expect_same(back->rig, rig);

  const Rigid3 body_from_rig{so3_exp({0.1, 0.2, 0.3}), {1, 2, 3}};
  for (RigCamera& camera : rig.cameras) camera.rig_from_cam = body_from_rig * camera.rig_from_cam;
  const auto on_body = parse_camchain(format_camchain(rig), "again.yaml");
  ASSERT_TRUE(on_body) << on_body.error().message;
  expect_same(on_body->rig, rig);

  rig.has_extrinsics = false;
  for (RigCamera& camera : rig.cameras) camera.rig_from_cam = {};
  const auto loose = parse_camchain(format_camchain(rig), "again.yaml");
  ASSERT_TRUE(loose) << loose.error().message;
  expect_same(loose->rig, rig);
}

}  // namespace
}  // namespace waymark
