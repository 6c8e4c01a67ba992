#include "core/camera/foreign_calibration.h"

#include <gmock/gmock.h>

#include "core/camera/kalibr.h"
#include "tests/support/foreign_calibrations.h"

namespace waymark {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string message_of(const std::string& text) {
  const auto loaded = parse_camchain(text, "rig.yaml");
  EXPECT_FALSE(loaded);
  if (loaded) return {};
  EXPECT_EQ(loaded.error().cause, Cause::format);
  return loaded.error().message;
}

TEST(ForeignCalibration, OtherProgramsCalibrationsAreReadAsTheRigOfOneCamera) {
  for (const char* text : {kRosCameraInfo, kOpenCvStorage}) {
    const auto loaded = parse_camchain(text, "rig.yaml");
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_EQ(loaded->rig.cameras.size(), 1U);
    const CameraParameters& p = loaded->rig.cameras[0].model.parameters();
    EXPECT_EQ(p.fu_px, 560.0);
    EXPECT_EQ(p.fv_px, 561.0);
    EXPECT_EQ(p.pu_px, 322.5);
    EXPECT_EQ(p.pv_px, 237.5);
    EXPECT_EQ(p.width_px, 640);
    EXPECT_EQ(p.height_px, 480);
    EXPECT_EQ(p.distortion, Distortion::radtan);
    EXPECT_EQ(p.coefficients, (LensCoefficients{-0.1, 0.02, 0.001, 0.002}));
    ASSERT_FALSE(loaded->notes.empty());
    EXPECT_THAT(loaded->notes[0], HasSubstr("another program's calibration"));
  }
}

TEST(ForeignCalibration, AForeignLensThatHasNoModelHereIsNamed) {
  EXPECT_THAT(message_of(replaced(kRosCameraInfo, "plumb_bob", "thin_prism")),
              AllOf(HasSubstr("a ROS camera_info"), HasSubstr("thin_prism")));
  EXPECT_THAT(message_of(replaced(kOpenCvStorage, "image_width", "width_of_image")),
              AllOf(HasSubstr("an OpenCV FileStorage"), HasSubstr("it lacks image_width")));
  // Without distortion, whatever the number of zeros.
  const auto straight = parse_camchain(
      replaced(kRosCameraInfo, "[-0.1, 0.02, 0.001, 0.002, 0.0]", "[0, 0, 0, 0, 0, 0, 0, 0]"),
      "rig.yaml");
  ASSERT_TRUE(straight);
  EXPECT_EQ(straight->rig.cameras[0].model.parameters().distortion, Distortion::none);
}

TEST(ForeignCalibration, FiveAndEightCoefficientsAreReadInOpenCvsOrder) {
  const auto lens_of = [](const char* text, const std::string& from, const std::string& to) {
    const auto loaded = parse_camchain(replaced(text, from, to), "rig.yaml");
    EXPECT_TRUE(loaded) << loaded.error().message;
    return loaded ? loaded->rig.cameras[0].model.parameters() : CameraParameters{};
  };
  for (const char* text : {kRosCameraInfo, kOpenCvStorage}) {
    const std::string storage = text;
    const auto begin = storage.find("data: [", storage.find("distortion_coefficients")) + 6;
    const std::string data = storage.substr(begin, storage.find(']', begin) + 1 - begin);
    const CameraParameters five = lens_of(text, data, "[-0.1, 0.02, 0.001, 0.002, -0.03]");
    EXPECT_EQ(five.distortion, Distortion::radtan5);
    EXPECT_EQ(five.coefficients, (LensCoefficients{-0.1, 0.02, 0.001, 0.002, -0.03}));
    const CameraParameters eight =
        lens_of(text, data, "[0.3, -0.1, 0.001, 0.002, -0.03, 0.4, 0.01, -0.02, 0, 0, 0, 0]");
    EXPECT_EQ(eight.distortion, Distortion::rational);
    EXPECT_EQ(eight.coefficients,
              (LensCoefficients{0.3, -0.1, 0.001, 0.002, -0.03, 0.4, 0.01, -0.02}));
    // Six of a rational's eight numbers, the others zero.
    EXPECT_EQ(lens_of(text, data, "[0.3, -0.1, 0, 0, -0.03, 0.4, 0, 0]").distortion,
              Distortion::rational);
    EXPECT_THAT(message_of(replaced(text, data, "[0.1, 0, 0, 0, 0, 0, 0, 0, 0.001, 0, 0, 0]")),
                HasSubstr("distortion coefficient 9 is 0.001; of a lens, 8 are read"));
  }
  EXPECT_EQ(lens_of(replaced(kRosCameraInfo, "plumb_bob", "rational_polynomial").c_str(),
                    "[-0.1, 0.02, 0.001, 0.002, 0.0]", "[0.3, -0.1, 0, 0, 0, 0.4, 0.01, -0.02]")
                .distortion,
            Distortion::rational);
}

TEST(ForeignCalibration, AFisheyeWithoutCoefficientsIsNoPinhole) {
  const std::string data = "[-0.1, 0.02, 0.001, 0.002, 0.0]";
  for (const char* model : {"equidistant", "fisheye"}) {
    const std::string fisheye = replaced(kRosCameraInfo, "plumb_bob", model);
    for (const char* coefficients : {"[0, 0, 0, 0]", "[0, 0, 0, 0, 0]", "[0.1, 0, 0, 0]"}) {
      const auto loaded = parse_camchain(replaced(fisheye, data, coefficients), "rig.yaml");
      ASSERT_TRUE(loaded) << loaded.error().message;
      const CameraParameters& p = loaded->rig.cameras[0].model.parameters();
      EXPECT_EQ(p.distortion, Distortion::equidistant) << model << coefficients;
      EXPECT_EQ(p.coefficients[0], coefficients[1] == '0' && coefficients[2] == '.' ? 0.1 : 0);
    }
    for (const char* coefficients : {"[]", "[0, 0, 0]", "[0, 0, 0, 0, 1]"}) {
      EXPECT_THAT(message_of(replaced(fisheye, data, coefficients)),
                  HasSubstr("distortion coefficients of the lens model equidistant; write 4"));
    }
  }
}

TEST(ForeignCalibration, WhatIsNoListOfCoefficientsIsNotTakenAsNone) {
  for (const char* text : {kRosCameraInfo, kOpenCvStorage}) {
    const std::string storage = text;
    const auto begin = storage.find("data: [", storage.find("distortion_coefficients")) + 6;
    const std::string data = storage.substr(begin, storage.find(']', begin) + 1 - begin);
    for (const char* other : {"[[-0.1, 0.02, 0.001, 0.002]]", "[a, 0, 0, 0]", "", "3", "{a: 1}",
                              "[~, 0, 0, 0]", "[\"\", 0, 0, 0]"}) {
      EXPECT_THAT(message_of(replaced(text, data, other)),
                  HasSubstr("its distortion coefficients are no list of numbers"))
          << other;
    }
    EXPECT_THAT(message_of(replaced(text, data, "[-0.1, 0.02]")),
                HasSubstr("2 distortion coefficients of the lens model plumb_bob; write 4"));
    EXPECT_THAT(message_of(replaced(text, "distortion_coefficients", "distortion")),
                HasSubstr("it lacks distortion_coefficients"));
    const auto none = parse_camchain(replaced(text, data, "[]"), "rig.yaml");
    ASSERT_TRUE(none) << none.error().message;
    EXPECT_EQ(none->rig.cameras[0].model.parameters().distortion, Distortion::none);
  }
  EXPECT_THAT(message_of(replaced(replaced(kRosCameraInfo, "plumb_bob", "rational_polynomial"),
                                  "[-0.1, 0.02, 0.001, 0.002, 0.0]", "[]")),
              HasSubstr("0 distortion coefficients"));
}

TEST(ForeignCalibration, AMatrixThatIsNoPinholeIsRefused) {
  const std::string matrix = "[560.0, 0.0, 322.5, 0.0, 561.0, 237.5, 0.0, 0.0, 1.0]";
  for (const char* other :
       {"[560, 0.5, 322.5, 0, 561, 237.5, 0, 0, 1]", "[560, 0, 322.5, 0.5, 561, 237.5, 0, 0, 1]",
        "[560, 0, 322.5, 0, 561, 237.5, 0.1, 0, 1]", "[560, 0, 322.5, 0, 561, 237.5, 0, 0.1, 1]",
        "[560, 0, 322.5, 0, 561, 237.5, 0, 0, 2]", "[560, 0, 322.5, 0, 561, 237.5, 0, 0, .nan]"}) {
    EXPECT_THAT(message_of(replaced(kRosCameraInfo, matrix, other)),
                HasSubstr("its camera_matrix is not fu 0 pu, 0 fv pv, 0 0 1"))
        << other;
  }
}

TEST(ForeignCalibration, ACamchainWithForeignKeysStaysACamchain) {
  for (const char* camera : {"cam0", "cam1", "cam07"}) {
    const auto foreign = camchain_of_foreign(
        YAML::Load(std::string(kRosCameraInfo) + camera + ": {intrinsics: [1, 2, 3, 4]}\n"),
        "rig.yaml");
    ASSERT_TRUE(foreign);
    EXPECT_FALSE(foreign->has_value()) << camera;
  }
}

TEST(ForeignCalibration, ACamchainIsNone) {
  const auto foreign =
      camchain_of_foreign(YAML::Load("cam0: {intrinsics: [1, 2, 3, 4]}"), "rig.yaml");
  ASSERT_TRUE(foreign);
  EXPECT_FALSE(foreign->has_value());
  EXPECT_EQ(without_opencv_directive("%YAML:1.0\na: 1"), "#YAML:1.0\na: 1");
  EXPECT_EQ(without_opencv_directive("a: 1"), "a: 1");
}

}  // namespace
}  // namespace waymark
