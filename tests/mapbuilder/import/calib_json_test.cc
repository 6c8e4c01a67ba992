#include "mapbuilder/import/calib_json.h"

#include <gmock/gmock.h>

#include "tests/support/bad_input.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

CalibJson good(const std::string& text) {
  const auto calib = parse_calib_json(text, "calib.json");
  EXPECT_TRUE(calib) << calib.error().message;
  return calib ? *calib : CalibJson();
}

TEST(CalibJson, CameraMatrixInEveryForm) {
  for (const char* matrix : {R"("camera_matrix": [[600, 0, 320], [0, 610, 240], [0, 0, 1]])",
                             R"("K": [600, 0, 320, 0, 610, 240, 0, 0, 1])",
                             R"("camera_matrix": {"type_id": "opencv-matrix", "rows": 3, "cols": 3,
                                "dt": "d", "data": [600.0, 0, 320, 0, 610, 240, 0, 0, 1.0]})",
                             R"("fx": 600, "fy": 610.0, "cx": 320, "cy": 240)"}) {
    const CalibJson calib =
        good(std::string("{") + matrix + R"(, "dist": [0.1, -0.2, 1e-3, 2e-3]})");
    EXPECT_EQ(calib.fu_px, 600) << matrix;
    EXPECT_EQ(calib.fv_px, 610);
    EXPECT_EQ(calib.pu_px, 320);
    EXPECT_EQ(calib.pv_px, 240);
    EXPECT_EQ(calib.coefficients, (LensCoefficients{0.1, -0.2, 1e-3, 2e-3}));
    EXPECT_FALSE(calib.size_px);
  }
}

TEST(CalibJson, DistortionInEveryForm) {
  const std::string start = R"({"fx": 600, "fy": 610, "cx": 320, "cy": 240, )";
  const auto lens_of = [&](const char* list) { return good(start + R"("dist": )" + list + "}"); };
  EXPECT_EQ(good(start + R"("distortion": [[0.1, 0.2, 0, 0, 0]]})").distortion, Distortion::radtan);
  EXPECT_EQ(lens_of("[[0.1, 0.2, 0, 0, 0]]").coefficients, (LensCoefficients{0.1, 0.2}));
  EXPECT_EQ(lens_of("[]").coefficients, LensCoefficients{});
  EXPECT_EQ(lens_of("[0.1, 0.2, 0, 0, 0.3]").distortion, Distortion::radtan5);
  EXPECT_EQ(lens_of("[0.1, 0.2, 0, 0, 0.3]").coefficients, (LensCoefficients{0.1, 0.2, 0, 0, 0.3}));
  EXPECT_EQ(lens_of("[1, 2, 3, 4, 5, 6, 7, 8, 0, 0]").distortion, Distortion::rational);
  EXPECT_EQ(lens_of("[1, 2, 3, 4, 5, 6, 7, 8, 0, 0]").coefficients,
            (LensCoefficients{1, 2, 3, 4, 5, 6, 7, 8}));
}

TEST(CalibJson, SizeWhenItIsStated) {
  const std::string start = R"({"fx": 600, "fy": 610, "cx": 320, "cy": 240, "dist": [], )";
  EXPECT_EQ(good(start + R"("width": 640, "height": 480})").size_px, std::pair(640, 480));
  EXPECT_EQ(good(start + R"("resolution": [640, 480]})").size_px, std::pair(640, 480));
}

class BadCalibJson : public testing::TestWithParam<BadInput> {};

TEST_P(BadCalibJson, IsRefusedInOneLine) {
  const auto calib = parse_calib_json(GetParam().text, "calib.json");
  ASSERT_FALSE(calib);
  EXPECT_EQ(calib.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(calib.error().message, HasSubstr("calib.json: "));
  EXPECT_THAT(calib.error().message, HasSubstr(GetParam().message));
  EXPECT_EQ(calib.error().message.find('\n'), std::string::npos);
}

#define FOCAL R"("fx": 600, "fy": 610, "cx": 320, "cy": 240)"

INSTANTIATE_TEST_SUITE_P(
    Cases, BadCalibJson,
    testing::Values(
        BadInput{"Empty", "", "not valid JSON"}, BadInput{"Cut", "{\"K\": [", "not valid JSON"},
        BadInput{"Array", "[1, 2]", "is no object"},
        BadInput{"DeepMatrix", "{\"K\": [[[[[[[[[]]]]]]]]]}", "nested deeper than 8 levels"},
        BadInput{"NoKeys", "{}", "keys seen: none"},
        BadInput{
            "OtherKeys", R"({"focal": 600, "dist": []})",
            "can't find the intrinsics (camera_matrix, or K, or fx, fy, cx and cy); keys seen: "
            "dist, focal"},
        BadInput{"NoDistortion", "{" FOCAL "}",
                 "can't find the distortion (dist or distortion); keys seen: cx, cy, fx, fy"},
        BadInput{"FocalAsText", R"({"fx": "600", "fy": 1, "cx": 1, "cy": 1, "dist": []})",
                 "can't find the intrinsics"},
        BadInput{"MatrixTooShort", R"({"K": [600, 0, 320], "dist": []})", "camera matrix must be"},
        BadInput{"MatrixWithSkew", R"({"K": [600, 1, 320, 0, 610, 240, 0, 0, 1], "dist": []})",
                 "camera matrix must be"},
        BadInput{"MatrixWithText", R"({"K": [[600, 0, "x"], [0, 1, 1], [0, 0, 1]], "dist": []})",
                 "camera matrix must be"},
        BadInput{"DistortionTooShort", "{" FOCAL R"(, "dist": [0.1, 0.2]})", "k1 k2 p1 p2"},
        BadInput{"DistortionAsText", "{" FOCAL R"(, "dist": "none"})", "k1 k2 p1 p2"},
        BadInput{"ThinPrism", "{" FOCAL R"(, "dist": [0.1, 0.2, 0, 0, 0.3, 0, 0, 0, 0.1]})",
                 "further ones must be 0"},
        BadInput{"NegativeWidth", "{" FOCAL R"(, "dist": [], "width": -640, "height": 480})",
                 "two whole numbers"},
        BadInput{"FractionalSize", "{" FOCAL R"(, "dist": [], "resolution": [640.5, 480]})",
                 "two whole numbers"},
        BadInput{"SizeAsText", "{" FOCAL R"(, "dist": [], "resolution": "640x480"})",
                 "two whole numbers"}),
    bad_input_name);

TEST(CalibJson, DepthTakesNoStack) {
  for (const char* level : {"[", "{\"K\":", "{\"dist\":[["}) {
    std::string text;
    for (int i = 0; i < 300'000; ++i) text += level;
    const auto calib = parse_calib_json(text, "calib.json");
    ASSERT_FALSE(calib);
    EXPECT_EQ(calib.error().kind, ErrorKind::bad_data);
  }
}

TEST(CalibJson, LargerThanAMebibyteIsRefused) {
  const std::string calib = R"({"fx": 600, "fy": 600, "cx": 320, "cy": 240, "dist": []})";
  const std::string most = calib + std::string((std::size_t{1} << 20) - calib.size(), ' ');
  const TemporaryFolder folder;
  EXPECT_TRUE(read_calib_json(folder.write("calib.json", most)));
  EXPECT_FALSE(read_calib_json(folder.write("calib.json", most + " ")));
}

TEST(CalibJson, AbsentFileIsNoInput) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_calib_json(folder.path() / "calib.json").error().kind, ErrorKind::no_input);
}

}  // namespace
}  // namespace waymark
