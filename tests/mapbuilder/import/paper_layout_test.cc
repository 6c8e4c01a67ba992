#include "mapbuilder/import/paper_layout.h"

#include <gmock/gmock.h>

#include "core/capture/image_file.h"
#include "tests/support/bad_input.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_pattern.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// As the paper's repository shows it.
constexpr const char* kSfmToml = R"([marker]
# 0:ARUCO_4X4_1000
type = 'aruco'
family = '4x4_1000'
board_size = [
        [
            0.3,
            0.25,
            0.35
        ],
        [
            ['default'],
            ['100-199'],
            ['200-299', 305]
        ]
    ]
)";

constexpr const char* kCalibJson =
    R"({"camera_matrix": [[60, 0, 31.5], [0, 60, 23.5], [0, 0, 1]], "dist": [0.01, 0, 0, 0, 0]})";

MarkerId aruco(int number) { return {Family::aruco_4x4_1000, number}; }

class PaperLayout : public testing::Test {
 protected:
  void make() const {
    folder_.write("sfm.toml", kSfmToml);
    folder_.write("calib.json", kCalibJson);
    add_image("images/2017-11-22_19-45-27_368.jpeg");
    add_image("images/2017-11-22_19-45-24_933.jpeg");
  }

  void add_image(const fs::path& name) const {
    fs::create_directories((folder_.path() / name).parent_path());
    ASSERT_TRUE(write_gray_image(folder_.path() / name, test_pattern(64, 48).view()));
  }

  [[nodiscard]] CaptureFolder good() const {
    auto capture = open_paper_layout(folder_.path());
    EXPECT_TRUE(capture) << capture.error().message;
    return capture ? std::move(*capture) : CaptureFolder();
  }

  void expect_failure(ErrorKind kind, const std::string& message) const {
    const auto capture = open_paper_layout(folder_.path());
    ASSERT_FALSE(capture) << "expected: " << message;
    EXPECT_EQ(capture.error().kind, kind) << capture.error().message;
    EXPECT_THAT(capture.error().message, HasSubstr(message));
    EXPECT_EQ(capture.error().message.find('\n'), std::string::npos);
  }

  TemporaryFolder folder_;
};

TEST_F(PaperLayout, IsOpenedAsACapture) {
  make();
  const CaptureFolder capture = good();
  ASSERT_EQ(capture.images.size(), 2U);
  EXPECT_EQ(capture.images[0].path.filename(), "2017-11-22_19-45-24_933.jpeg");
  EXPECT_FALSE(capture.stamps_from_names);
  EXPECT_EQ(capture.images[1].stamp, std::chrono::seconds(1));

  EXPECT_EQ(capture.catalog.size_m(aruco(7)), 0.3);
  EXPECT_EQ(capture.catalog.size_m(aruco(100)), 0.25);
  EXPECT_EQ(capture.catalog.size_m(aruco(299)), 0.35);
  EXPECT_EQ(capture.catalog.size_m(aruco(305)), 0.35);
  EXPECT_EQ(capture.catalog.size_m(aruco(306)), 0.3);

  ASSERT_EQ(capture.rig.cameras.size(), 1U);
  const CameraParameters& camera = capture.rig.cameras[0].model.parameters();
  EXPECT_EQ(capture.rig.cameras[0].name, "cam0");
  EXPECT_EQ(camera.width_px, 64) << "from the first image";
  EXPECT_EQ(camera.height_px, 48);
  EXPECT_EQ(camera.fu_px, 60);
  EXPECT_EQ(camera.distortion, Distortion::radtan);
  EXPECT_EQ(camera.coefficients[0], 0.01);
  EXPECT_FALSE(capture.detections_csv);
}

TEST_F(PaperLayout, RigYamlBeatsCalibJson) {
  make();
  folder_.write("rig.yaml", tiny_rig_yaml(1));
  folder_.write("calib.json", "{}");
  EXPECT_EQ(good().rig.cameras[0].model.parameters().distortion, Distortion::none);
}

TEST_F(PaperLayout, SeveralCamerasLieInFoldersOfTheirOwn) {
  folder_.write("sfm.toml", kSfmToml);
  folder_.write("rig.yaml", tiny_rig_yaml(2));
  add_image("images/5.png");
  expect_failure(ErrorKind::bad_data, "rig.yaml names 2 cameras");
  add_image("images/cam0/5.png");
  expect_failure(ErrorKind::bad_data, "no folder cam1");
  add_image("images/cam1/5.png");
  const CaptureFolder capture = good();
  ASSERT_EQ(capture.images.size(), 2U);
  EXPECT_EQ(capture.images[1].camera, 1);
  EXPECT_TRUE(capture.stamps_from_names);
}

TEST_F(PaperLayout, DetectionsAndSurveyAreFound) {
  make();
  folder_.write("detections.csv", "");
  folder_.write("survey.toml", "");
  const CaptureFolder capture = good();
  EXPECT_EQ(capture.detections_csv, folder_.path() / "detections.csv");
  EXPECT_EQ(capture.survey_toml, folder_.path() / "survey.toml");
}

TEST_F(PaperLayout, DetectionsAloneNeedASizeOrARig) {
  make();
  fs::remove_all(folder_.path() / "images");
  folder_.write("detections.csv", "");
  expect_failure(ErrorKind::bad_data, "states no width and height");
  folder_.write("rig.yaml", tiny_rig_yaml(1));
  EXPECT_TRUE(open_paper_layout(folder_.path()));
}

TEST_F(PaperLayout, FamiliesInTheirSpellingsAndOurs) {
  make();
  const auto family_of = [&](const std::string& lines) {
    folder_.write("sfm.toml", "[marker]\n" + lines + "board_size = 0.2\n");
    const CaptureFolder capture = good();
    EXPECT_EQ(capture.catalog.size_m({*capture.catalog.only_family(), 3}), 0.2);
    return *capture.catalog.only_family();
  };
  EXPECT_EQ(family_of("type='aruco'\nfamily='4x4_1000'\n"), Family::aruco_4x4_1000);
  EXPECT_EQ(family_of("type='ARUCO'\nfamily='ORIGINAL'\n"), Family::aruco_original);
  EXPECT_EQ(family_of("type='aruco_original'\n"), Family::aruco_original);
  EXPECT_EQ(family_of("type='APRILTAG'\nfamily='tag36h11'\n"), Family::tag36h11);
  EXPECT_EQ(family_of("type='apriltag'\nfamily='25h9'\n"), Family::tag25h9);
  EXPECT_EQ(family_of("family='aruco_5x5_100'\n"), Family::aruco_5x5_100);
}

TEST_F(PaperLayout, MissingPiecesAreNoInput) {
  make();
  fs::remove(folder_.path() / "calib.json");
  expect_failure(ErrorKind::no_input, "neither rig.yaml nor calib.json");
  fs::remove_all(folder_.path() / "images");
  expect_failure(ErrorKind::no_input, "no folder images and no detections.csv");
  fs::create_directory(folder_.path() / "images");
  expect_failure(ErrorKind::no_input, "images: empty");
}

TEST_F(PaperLayout, CalibrationThatMakesNoSenseIsBadData) {
  make();
  folder_.write("calib.json", R"({"fx": -60, "fy": 60, "cx": 31, "cy": 23, "dist": []})");
  expect_failure(ErrorKind::bad_data, "calib.json: ");
  folder_.write("calib.json", R"({"focal": 60})");
  expect_failure(ErrorKind::bad_data, "keys seen: focal");
}

class BadSfmToml : public PaperLayout, public testing::WithParamInterface<BadInput> {};

TEST_P(BadSfmToml, IsRefusedInOneLine) {
  make();
  folder_.write("sfm.toml", GetParam().text);
  expect_failure(ErrorKind::bad_data, "sfm.toml");
  expect_failure(ErrorKind::bad_data, GetParam().message);
}

#define FAMILY "[marker]\ntype = 'aruco'\nfamily = '4x4_1000'\n"

INSTANTIATE_TEST_SUITE_P(
    Cases, BadSfmToml,
    testing::Values(
        BadInput{"Empty", "", "no [marker] table"},
        BadInput{"NotToml", "[marker", "not valid TOML"},
        BadInput{"UnknownFamily", "[marker]\ntype='aruco'\nfamily='9x9'\nboard_size=0.1\n",
                 "unknown markers: type \"aruco\", family \"9x9\""},
        BadInput{"FamilyOfAnotherType",
                 "[marker]\ntype='aruco'\nfamily='tag36h11'\nboard_size=0.1\n", "unknown markers"},
        BadInput{"NoSize", FAMILY, "no board_size"},
        BadInput{"NegativeSize", FAMILY "board_size = [[-0.3], [['default']]]\n", "size_m must be"},
        BadInput{"SizeAsText", FAMILY "board_size = [['0.3'], [['default']]]\n",
                 "each size must be a number"},
        BadInput{"FewerGroupsThanSizes", FAMILY "board_size = [[0.3, 0.2], [['default']]]\n",
                 "as many groups as sizes"},
        BadInput{"NoGroups", FAMILY "board_size = [[0.3]]\n", "as many groups as sizes"},
        BadInput{"GroupNoList", FAMILY "board_size = [[0.3], ['default']]\n", "each group a list"},
        BadInput{"TwoDefaults", FAMILY "board_size = [[0.3, 0.2], [['default'], ['default']]]\n",
                 "two sizes are the default"},
        BadInput{"IdInTwoRanges", FAMILY "board_size = [[0.3, 0.2], [['1-5'], ['5']]]\n",
                 "id 5 has a size already"},
        BadInput{"BadRange", FAMILY "board_size = [[0.3], [['all']]]\n", "\"all\" is no id"},
        BadInput{"QuotesInRange", FAMILY "board_size = [[0.3], [[\"'''\"]]]\n", "not valid TOML"},
        BadInput{"IdNoTextNorNumber", FAMILY "board_size = [[0.3], [[true]]]\n", "\"?\" is no id"}),
    bad_input_name);

TEST_F(PaperLayout, IsKnownBySfmToml) {
  EXPECT_FALSE(is_paper_layout(folder_.path()));
  make();
  EXPECT_TRUE(is_paper_layout(folder_.path()));
  folder_.write("markers.toml", tiny_markers_toml());
  EXPECT_FALSE(is_paper_layout(folder_.path()));
}

}  // namespace
}  // namespace waymark
