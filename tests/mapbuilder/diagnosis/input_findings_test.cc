#include "mapbuilder/diagnosis/input_findings.h"

#include <gmock/gmock.h>

#include <functional>

#include "core/capture/image_file.h"
#include "mapbuilder/observations/detect_capture.h"
#include "tests/support/printed_wall.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using test::Print;
using testing::HasSubstr;

using Change = std::function<GrayImage(GrayImage)>;

GrayImage as_it_is(GrayImage image) { return image; }

/// What a camera took.
struct Taken {
  Print print;
  Change change = as_it_is;
};

/// A capture folder of images; one camera per element.
class InputFindings : public testing::Test {
 protected:
  [[nodiscard]] std::vector<Finding> find(const std::string& family,
                                          const std::vector<Taken>& cameras,
                                          const std::string& more_markers = "") {
    return find_by("[markers]\nfamily = \"" + family + "\"\nsize_m = 0.2\n" + more_markers,
                   cameras);
  }

  [[nodiscard]] std::vector<Finding> find_by(const std::string& markers_toml,
                                             const std::vector<Taken>& cameras) {
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      std::filesystem::remove_all(entry.path());
    }
    folder.write("markers.toml", markers_toml);
    std::string rig;
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      const std::string name = "cam" + std::to_string(c);
      rig += name +
             ":\n  camera_model: pinhole\n  intrinsics: [600, 600, 319.5, 239.5]\n"
             "  distortion_model: none\n  distortion_coeffs: []\n  resolution: [640, 480]\n";
      if (c > 0) {
        rig +=
            "  T_cn_cnm1:\n  - [1, 0, 0, 0.1]\n  - [0, 1, 0, 0]\n  - [0, 0, 1, 0]\n"
            "  - [0, 0, 0, 1]\n";
      }
      for (int i = 0; i < kImages; ++i) {
        const auto path =
            folder.path() / name /
            (std::to_string(1'700'000'000'000'000'000 + 1'000'000'000LL * i) + ".pgm");
        std::filesystem::create_directories(path.parent_path());
        const GrayImage image = cameras[c].change(test::wall_with(cameras[c].print, 3 * i));
        EXPECT_TRUE(write_gray_image(path, image.view()));
      }
    }
    folder.write("rig.yaml", rig);
    const auto capture = open_capture_folder(folder.path());
    if (!capture) {
      ADD_FAILURE() << capture.error().message;
      return {};
    }
    Progress progress(false);
    DetectionReport report;
    const auto detected = detect_capture(*capture, {}, progress, report);
    if (!detected) {
      ADD_FAILURE() << detected.error().message;
      return {};
    }
    markers_found = report.detections;
    return input_findings(*detected, look_at_images(*capture, *detected, 1, progress));
  }

  /// Exactly one finding; its line holds all the words.
  static void expect_one(const std::vector<Finding>& findings, Severity severity, Cause cause,
                         const std::vector<std::string>& words) {
    std::string all;
    for (const Finding& finding : findings) all += one_line(finding) + "\n";
    ASSERT_EQ(findings.size(), 1U) << all;
    EXPECT_EQ(findings[0].severity, severity) << all;
    EXPECT_EQ(findings[0].cause, cause) << all;
    for (const std::string& word : words) EXPECT_THAT(all, HasSubstr(word));
    EXPECT_FALSE(findings[0].remedy.empty());
  }

  static constexpr int kImages = 3;
  test::TemporaryFolder folder;
  std::size_t markers_found = 0;
};

/// Families printed, and what was stated.
struct OtherFamily {
  Family printed;
  const char* stated;
  const char* told;  ///< the family to state
};

TEST_F(InputFindings, AnotherFamilyIsNamed) {
  for (const auto& [printed, stated, told] :
       {OtherFamily{Family::tag25h9, "tag36h11", "tag25h9 (ids 0-7)"},
        OtherFamily{Family::tag36h11, "aruco_6x6_250", "tag36h11 (ids 0-7)"},
        OtherFamily{Family::tag36h10, "tag36h11", "tag36h10 (ids 0-7)"},
        OtherFamily{Family::tag16h5, "tag36h11", "tag16h5 (ids 0-7)"},
        OtherFamily{Family::aruco_original, "aruco_5x5_1000", "aruco_original (ids 0-7)"},
        OtherFamily{Family::aruco_4x4_50, "aruco_5x5_1000", "aruco_4x4_50 (ids 0-7)"},
        OtherFamily{Family::aruco_5x5_1000, "tag36h11", "aruco_5x5_50 (ids 0-7)"},
        OtherFamily{Family::aruco_6x6_1000, "aruco_4x4_50", "aruco_6x6_50 (ids 0-7)"},
        OtherFamily{Family::aruco_7x7_1000, "aruco_original", "aruco_7x7_50 (ids 0-7)"}}) {
    Print print;
    print.family = printed;
    expect_one(find(stated, {{print}}), Severity::error, Cause::family,
               {told, "State that family"});
  }
}

TEST_F(InputFindings, OfALargerFamilyThatTheStatedOneBeginsTheRestIsAWarning) {
  Print print;
  print.family = Family::aruco_4x4_1000;
  print.numbers = {1, 2, 80, 300, 512, 700, 811, 999};
  expect_one(find("aruco_4x4_50", {{print}}), Severity::warning, Cause::family,
             {"18 squares read as aruco_4x4_1000"});
  EXPECT_EQ(markers_found, 6U);
}

TEST_F(InputFindings, MirroredImagesAreNamedOfAllAndOfOneCamera) {
  for (const Family family : {Family::tag36h11, Family::tag16h5, Family::tag25h9,
                              Family::aruco_4x4_50, Family::aruco_4x4_1000, Family::aruco_5x5_250,
                              Family::aruco_6x6_100, Family::aruco_7x7_1000}) {
    Print print;
    print.family = family;
    const auto findings = find(std::string(name_of(family)), {{print, test::mirrored}});
    ASSERT_FALSE(findings.empty()) << name_of(family);
    EXPECT_EQ(findings[0].cause, Cause::mirrored) << one_line(findings[0]);
    EXPECT_EQ(findings[0].severity, Severity::error) << one_line(findings[0]);
  }
  const auto one = find("tag36h11", {{{}}, {{}, test::mirrored}});
  expect_one(one, Severity::error, Cause::mirrored,
             {"] cam1: ", "the images of cam1 are mirrored"});
}

TEST_F(InputFindings, AFamilyWhoseMirroredCodesAreCodesIsToldByWhatStandsOnItsHead) {
  Print print;
  print.family = Family::aruco_original;
  print.numbers = {1, 5, 10, 26, 100, 300, 511, 1000};
  expect_one(find("aruco_original", {{print, test::mirrored}}), Severity::error, Cause::mirrored,
             {"24 of 24 markers stand upside down"});
  EXPECT_TRUE(find("aruco_original", {{print}}).empty());
}

TEST_F(InputFindings, PrintsThatAreWhiteOnBlackAreNamed) {
  for (const Family family : {Family::tag36h11, Family::aruco_4x4_50, Family::aruco_original}) {
    Print print;
    print.family = family;
    print.inverted = true;
    expect_one(find(std::string(name_of(family)), {{print}}), Severity::error,
               Cause::inverted_print, {"white on black"});
  }
}

TEST_F(InputFindings, ABorderOfTwoCellsIsNamed) {
  for (const Family family : {Family::tag36h11, Family::tag25h9, Family::aruco_5x5_100}) {
    Print print;
    print.family = family;
    print.border_cells = 2;
    print.side_px = 100;
    expect_one(find(std::string(name_of(family)), {{print}}), Severity::error, Cause::border,
               {"a black border of 2.", "Print with a border of one cell"});
  }
}

TEST_F(InputFindings, MarkersWithoutAMarginOnADarkWallAreToldByTheirCodes) {
  for (const Family family : {Family::tag36h11, Family::aruco_5x5_100}) {
    Print print;
    print.family = family;
    print.margin_cells = 0;
    print.wall = print.black;
    expect_one(find(std::string(name_of(family)), {{print}}), Severity::error, Cause::margin,
               {"stand dark on dark", "white paper"});
  }
}

TEST_F(InputFindings, ABorderThatWasCutIsToldThoughAllIsFound) {
  Print print;
  print.border_cells = 0.5;
  const auto findings = find("tag36h11", {{print}});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].cause, Cause::border);
  EXPECT_THAT(one_line(findings[0]), HasSubstr("0.5 cells"));
}

TEST_F(InputFindings, UnlistedIdsAreNamed) {
  const std::string listed = "[markers]\nfamily = \"tag36h11\"\n[[markers.sizes]]\nsize_m = 0.2\n";
  expect_one(find_by(listed + "ids = \"1-3\"\n", {{{}}}), Severity::note, Cause::unlisted_ids,
             {"ids 0, 4-7 were seen 15 times", "`ignore`"});
  EXPECT_EQ(markers_found, 9U);
  expect_one(find_by(listed + "ids = \"10-30\"\n", {{{}}}), Severity::error, Cause::unlisted_ids,
             {"ids 0-7 were seen 24 times", "nothing else was found"});
  EXPECT_TRUE(find("tag36h11", {{{}}}, "ignore = \"0-3\"\n").empty()) << "ignored ones are known";
}

TEST_F(InputFindings, DarknessAndBlindCamerasAreNamed) {
  const Change dark = [](GrayImage image) { return test::darkened(std::move(image), 0.02); };
  expect_one(find("tag36h11", {{{}, dark}}), Severity::error, Cause::dark,
             {"nearly black (mean 2"});
  expect_one(find("tag36h11", {{{}}, {{}, dark}}), Severity::warning, Cause::blind_camera,
             {"] cam1: found no marker in 3 images (mean grey level 2", "could not be checked"});
  Print bare;
  bare.numbers = {};
  expect_one(find("tag36h11", {{{}}, {bare}}), Severity::warning, Cause::blind_camera,
             {"] cam1: found no marker in 3 images (mean grey level 120"});
  expect_one(find("tag36h11", {{bare}}), Severity::error, Cause::blind_camera,
             {"no marker in 3 images"});
}

TEST_F(InputFindings, NothingIsSaidOfSoundPrints) {
  for (const FamilyTraits& family : all_families()) {
    Print print;
    print.family = family.family;
    const MarkerLayout& layout = marker_layout(family.family);
    print.side_px *= static_cast<double>(layout.square_cells()) / layout.all_cells();
    const auto findings = find(std::string(family.name), {{print}, {print}});
    EXPECT_TRUE(findings.empty()) << family.name << ": " << one_line(findings[0]);
    EXPECT_EQ(markers_found, 16U * kImages) << family.name;
  }
  for (const double margin : {0.5, 2.0}) {
    Print print;
    print.margin_cells = margin;
    print.wall = 70;
    EXPECT_TRUE(find("tag36h11", {{print}}).empty()) << margin;
  }
}

}  // namespace
}  // namespace waymark
