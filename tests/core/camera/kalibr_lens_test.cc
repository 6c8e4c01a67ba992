#include "core/camera/kalibr_lens.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/camera/kalibr.h"

namespace waymark {
namespace {

using ::testing::HasSubstr;

/// A camchain of one camera of 640×480 px.
std::string lens_text(const std::string& model, const std::string& intrinsics,
                      const std::string& distortion, const std::string& coefficients) {
  return fmt::format(
      "cam0:\n  camera_model: {}\n  intrinsics: [{}]\n  distortion_model: {}\n"
      "  distortion_coeffs: [{}]\n  resolution: [640, 480]\n",
      model, intrinsics, distortion, coefficients);
}

std::string message_of(const std::string& text) {
  const auto loaded = parse_camchain(text, "rig.yaml");
  if (loaded) return "no error";
  EXPECT_EQ(loaded.error().kind, ErrorKind::bad_data);
  EXPECT_EQ(loaded.error().message.find('\n'), std::string::npos);
  return loaded.error().message;
}

struct GoodLens {
  Distortion distortion;
  std::string text;
  LensCoefficients coefficients;
};

const std::string kFour = "560, 561, 322.5, 237.5";
const GoodLens kGoodLenses[] = {
    {Distortion::none, lens_text("pinhole", kFour, "none", ""), {}},
    {Distortion::radtan,
     lens_text("pinhole", kFour, "radtan", "-0.1, 0.02, 0.001, 0.002"),
     {-0.1, 0.02, 0.001, 0.002}},
    {Distortion::radtan5,
     lens_text("pinhole", kFour, "radtan", "-0.1, 0.02, 0.001, 0.002, -0.01"),
     {-0.1, 0.02, 0.001, 0.002, -0.01}},
    // A fifth that is zero may be refined.
    {Distortion::radtan5,
     lens_text("pinhole", kFour, "radtan", "-0.1, 0.02, 0, 0, 0"),
     {-0.1, 0.02}},
    {Distortion::rational,
     lens_text("pinhole", kFour, "rational", "0.3, -0.1, 0.001, 0.002, 0.01, 0.4, -0.02, 0.03"),
     {0.3, -0.1, 0.001, 0.002, 0.01, 0.4, -0.02, 0.03}},
    {Distortion::equidistant,
     lens_text("pinhole", kFour, "equidistant", "0.01, -0.01, 0.001, 0.002"),
     {0.01, -0.01, 0.001, 0.002}},
    {Distortion::eucm, lens_text("eucm", "0.6, 1.1, " + kFour, "none", ""), {0.6, 1.1}},
    {Distortion::double_sphere,
     lens_text("ds", "-0.2, 0.6, " + kFour, "none", "0, 0, 0, 0"),
     {-0.2, 0.6}},
};

TEST(KalibrLens, IsReadAndReadsBack) {
  for (const GoodLens& good : kGoodLenses) {
    const auto loaded = parse_camchain(good.text, "rig.yaml");
    ASSERT_TRUE(loaded) << loaded.error().message;
    CameraParameters p = loaded->rig.cameras[0].model.parameters();
    EXPECT_EQ(p.distortion, good.distortion) << good.text;
    EXPECT_EQ(p.coefficients, good.coefficients) << good.text;
    EXPECT_EQ(p.fv_px, 561);
    EXPECT_EQ(p.pu_px, 322.5);
    Rig rig = loaded->rig;
    p.valid_radius_px = 287.5;
    rig.cameras[0].model = *CameraModel::create(p);
    const auto again = parse_camchain(format_camchain(rig), "again.yaml");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->rig.cameras[0].model.parameters(), p);
  }
}

TEST(KalibrLens, NumbersThatNoLensHasAreRefused) {
  const auto refused = [](const std::string& model, const std::string& intrinsics,
                          const std::string& distortion, const std::string& coefficients) {
    return message_of(lens_text(model, intrinsics, distortion, coefficients));
  };
  EXPECT_THAT(refused("pinhole", kFour, "radtan", "0, 0, 0"),
              HasSubstr("line 5: cam0: distortion_coeffs: a list of 3 instead of a list of 4 or 5 "
                        "numbers (k1 k2 p1 p2 k3)"));
  EXPECT_THAT(refused("pinhole", kFour, "radtan", "0, 0, 0, 0, 0, 0"), HasSubstr("a list of 6"));
  EXPECT_THAT(refused("pinhole", kFour, "rational", "0, 0, 0, 0, 0, 0, 0"),
              HasSubstr("a list of 7 instead of a list of 8 numbers"));
  EXPECT_THAT(refused("pinhole", kFour, "rational", "0, 0, 0, 0, 0, 0, 0, .nan"),
              HasSubstr("is not finite"));
  EXPECT_THAT(refused("eucm", kFour, "none", ""),
              HasSubstr("intrinsics: a list of 4 instead of a list of 6"));
  EXPECT_THAT(refused("eucm", "0.6, 1.1, " + kFour, "none", "0.1, 0, 0, 0"),
              HasSubstr("are not zero although distortion_model is none"));
  EXPECT_THAT(refused("eucm", "1.01, 1.1, " + kFour, "none", ""),
              HasSubstr("lens eucm: alpha is 1.01; it must be from 0 to 1"));
  EXPECT_THAT(refused("eucm", "-0.01, 1.1, " + kFour, "none", ""), HasSubstr("alpha is -0.01"));
  EXPECT_THAT(refused("eucm", "0.6, 0, " + kFour, "none", ""), HasSubstr("beta is 0"));
  EXPECT_THAT(refused("eucm", "0.6, .nan, " + kFour, "none", ""), HasSubstr("is not finite"));
  EXPECT_THAT(refused("eucm", "0.6, 1.1, -560, 561, 322.5, 237.5", "none", ""),
              HasSubstr("focal lengths"));
  EXPECT_THAT(refused("ds", "-1, 0.6, " + kFour, "none", ""), HasSubstr("lens ds: xi is -1"));
  EXPECT_THAT(refused("ds", "1.1, 0.6, " + kFour, "none", ""), HasSubstr("xi is 1.1"));
  EXPECT_THAT(refused("ds", "-0.2, 1.6, " + kFour, "none", ""), HasSubstr("alpha is 1.6"));
}

TEST(KalibrLens, ThatTurnsOverInTheImageIsReadWithItsRadius) {
  // 1 + 3 k1 r² = 0 at r = 0.745: 278 px of 640×480, whose corners lie 403 px off.
  const auto loaded =
      parse_camchain(lens_text("pinhole", kFour, "radtan", "-0.6, 0, 0, 0"), "rig.yaml");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(loaded->notes,
              ::testing::ElementsAre(HasSubstr("cam0: farther than 273 px from the principal point "
                                               "the calibration says nothing")));
  const double turn_px = 560 * std::sqrt(1 / 1.8) * 2 / 3;
  EXPECT_NEAR(loaded->rig.cameras[0].model.valid_radius_px(), 0.98 * turn_px, 1e-6);
}

}  // namespace
}  // namespace waymark
