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
    EXPECT_EQ(p.coefficients, (std::array<double, 4>{-0.1, 0.02, 0.001, 0.002}));
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
