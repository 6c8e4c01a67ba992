#include "mapbuilder/commands/print_command.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "core/capture/image_file.h"
#include "core/detect/image_detector.h"
#include "core/marker/marker_catalog.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

/// What a person does with the command: print, look at the sheets, read markers.toml.
class PrintedMarkers : public testing::Test {
 protected:
  Status print(PrintOptions options) {
    options.output = folder_.path() / "markers.pdf";
    return run_print(options, out_);
  }

  /// Markers of all pages, seen by a camera of so many pixels a mm.
  std::vector<Detection> seen(int dots_per_inch) {
    const auto pages = folder_.path() / "pages";
    std::filesystem::create_directories(pages);
    const std::string command =
        std::string(PDFTOPPM) + " -gray -r " + std::to_string(dots_per_inch) + " " +
        (folder_.path() / "markers.pdf").string() + " " + (pages / "page").string();
    EXPECT_EQ(std::system(command.c_str()), 0);  // NOLINT(cert-env33-c,concurrency-mt-unsafe)
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(pages)) files.push_back(entry);
    std::sort(files.begin(), files.end());
    const auto catalog = read_marker_catalog(folder_.path() / "markers.toml");
    EXPECT_TRUE(catalog);
    ImageDetector detector(*catalog);
    std::vector<Detection> all;
    for (const auto& file : files) {
      const auto loaded = read_gray_image(file);
      EXPECT_TRUE(loaded) << file;
      CameraParameters parameters;
      parameters.width_px = loaded->image.width_px;
      parameters.height_px = loaded->image.height_px;
      parameters.fu_px = parameters.fv_px = 3000;
      parameters.pu_px = parameters.width_px / 2.0;
      parameters.pv_px = parameters.height_px / 2.0;
      const FoundMarkers& found =
          detector.detect(loaded->image.view(), *CameraModel::create(parameters));
      all.insert(all.end(), found.detections.begin(), found.detections.end());
    }
    return all;
  }

  /// All of a family's `numbers`, each once, upright, every side within 0.1 mm.
  void expect_printed(Family family, const std::vector<int>& numbers, double size_m,
                      int dots_per_inch) {
    const double mm_per_px = 25.4 / dots_per_inch;
    std::vector<int> found;
    for (const Detection& one : seen(dots_per_inch)) {
      if (one.marker.family != family) continue;
      found.push_back(one.marker.number);
      for (std::size_t i = 0; i < 4; ++i) {
        const double side_px = (one.corners[(i + 1) % 4] - one.corners[i]).norm();
        EXPECT_NEAR(mm_per_px * side_px, 1e3 * size_m, 0.1) << name_of(family);
      }
      EXPECT_LT(one.corners[0].x(), one.corners[1].x() - 1) << "top left is left of top right";
      EXPECT_LT(one.corners[0].y(), one.corners[3].y() - 1) << "and above bottom left";
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, numbers) << name_of(family);
  }

  TemporaryFolder folder_;
  std::ostringstream out_;
};

class PrintedFamilies : public PrintedMarkers, public testing::WithParamInterface<FamilyTraits> {};

TEST_P(PrintedFamilies, AreReadBackUprightAndOfTheirSize) {
  const FamilyTraits family = GetParam();
  const int last = family.id_count - 1;
  const std::vector<int> numbers{0, 1, last / 2, last};
  const std::string ids = "0-1," + std::to_string(last / 2) + "," + std::to_string(last);
  const auto printed = print({{std::string(family.name)}, {ids}, {0.06}, "a4", {}});
  ASSERT_TRUE(printed) << printed.error().message;
  expect_printed(family.family, numbers, 0.06, 300);
}

INSTANTIATE_TEST_SUITE_P(All, PrintedFamilies, testing::ValuesIn(all_families()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_F(PrintedMarkers, AreAsExactAtSixHundredDots) {
  ASSERT_TRUE(print({{"tag36h11"}, {"7"}, {0.1}, "a4", {}}));
  expect_printed(Family::tag36h11, {7}, 0.1, 600);
}

TEST_F(PrintedMarkers, OfSeveralFamiliesAndSizesHaveOneMarkersToml) {
  ASSERT_TRUE(print(
      {{"tag36h11", "aruco_4x4_50", "tag36h11"}, {"0-2", "5", "9"}, {0.05, 0.04, 0.16}, "a4", {}}));
  const auto catalog = read_marker_catalog(folder_.path() / "markers.toml");
  ASSERT_TRUE(catalog) << catalog.error().message;
  EXPECT_EQ(catalog->size_m({Family::tag36h11, 2}), 0.05);
  EXPECT_EQ(catalog->size_m({Family::tag36h11, 9}), 0.16);
  EXPECT_EQ(catalog->size_m({Family::aruco_4x4_50, 5}), 0.04);
  EXPECT_EQ(catalog->size_m({Family::tag36h11, 3}), std::nullopt);
}

TEST_F(PrintedMarkers, ALostSheetIsPrintedAgainAndMarkersTomlStays) {
  ASSERT_TRUE(print({{"tag36h11"}, {"0-20"}, {0.16}, "a4", {}}));
  const auto toml = folder_.path() / "markers.toml";
  const std::string before = folder_.read("markers.toml");
  ASSERT_TRUE(print({{"tag36h11"}, {"17"}, {0.16}, "a4", {}}));
  EXPECT_EQ(folder_.read("markers.toml"), before);
  EXPECT_NE(out_.str().find("(as it was)"), std::string::npos);
}

TEST_F(PrintedMarkers, ALostSheetIsPrintedAgainThoughTheRulerWasShort) {
  folder_.write("markers.toml",
                "[markers]\nfamily = \"tag36h11\"\nsize_m = 0.16\nprint_scale = 0.97\n");
  const auto printed = print({{"tag36h11"}, {"17"}, {0.16}, "a4", {}});
  EXPECT_TRUE(printed) << printed.error().message;
  EXPECT_FALSE(print({{"tag36h11"}, {"17"}, {0.16 * 0.97}, "a4", {}}));
}

TEST_F(PrintedMarkers, AnotherSizeThanMarkersTomlStatesIsRefused) {
  ASSERT_TRUE(print({{"tag36h11"}, {"0-20"}, {0.16}, "a4", {}}));
  std::filesystem::remove(folder_.path() / "markers.pdf");
  for (const auto& [ids, size_m] : {std::pair{"17", 0.2}, {"17", 0.161}, {"21", 0.16}}) {
    const auto printed = print({{"tag36h11"}, {ids}, {size_m}, "a4", {}});
    ASSERT_FALSE(printed);
    EXPECT_EQ(printed.error().kind, ErrorKind::bad_data);
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "markers.pdf"));
  }
}

TEST_F(PrintedMarkers, WhatMarkersTomlStatesAsInvertedIsNotPrintedTheOtherWay) {
  const std::string toml = "[markers]\nfamily = \"tag36h11\"\nsize_m = 0.16\n";
  for (const bool inverted : {true, false}) {
    folder_.write("markers.toml", toml + (inverted ? "inverted = true\n" : "inverted = false\n"));
    const auto printed = print({{"tag36h11"}, {"17"}, {0.16}, "a4", {}});
    EXPECT_EQ(printed.has_value(), !inverted);
    if (!printed) {
      EXPECT_EQ(printed.error().kind, ErrorKind::bad_data);
    }
    EXPECT_EQ(std::filesystem::exists(folder_.path() / "markers.pdf"), !inverted);
  }
}

TEST(PrintAdvice, NeedsARange) {
  std::ostringstream out;
  const auto advice = run_print_advice({true, "rig.yaml", std::nullopt}, out, out);
  ASSERT_FALSE(advice);
  EXPECT_NE(advice.error().message.find("--range-m, the farthest"), std::string::npos);
}

struct BadOrder {
  const char* name;
  PrintOptions options;
  const char* why;
};

class BadOrders : public PrintedMarkers, public testing::WithParamInterface<BadOrder> {};

TEST_P(BadOrders, AreRefusedAndNothingIsWritten) {
  const auto printed = print(GetParam().options);
  ASSERT_FALSE(printed);
  EXPECT_EQ(printed.error().kind, ErrorKind::usage);
  EXPECT_NE(printed.error().message.find(GetParam().why), std::string::npos)
      << printed.error().message;
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "markers.pdf"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "markers.toml"));
}

/// All ids of a family, a hundred thousand times.
std::string many_ranges() {
  std::string ids = "0-586";
  for (int i = 0; i < 100'000; ++i) ids += ",0-586";
  return ids;
}

INSTANTIATE_TEST_SUITE_P(
    All, BadOrders,
    testing::Values(
        BadOrder{"UnknownFamily", {{"tag99"}, {"0"}, {0.1}, "a4", {}}, "one of"},
        BadOrder{"NoIds", {{"tag36h11"}, {}, {0.1}, "a4", {}}, "give --ids"},
        BadOrder{"NoFamily", {{}, {"0"}, {0.1}, "a4", {}}, "give --ids"},
        BadOrder{"NoSize", {{"tag36h11"}, {"0"}, {}, "a4", {}}, "give --ids"},
        BadOrder{"TwoSizesForThreeIds",
                 {{"tag36h11"}, {"0", "1", "2"}, {0.1, 0.2}, "a4", {}},
                 "as often as"},
        BadOrder{"IdBeyond", {{"tag36h11"}, {"587"}, {0.1}, "a4", {}}, "0 to 586"},
        BadOrder{"IdsNoNumbers", {{"tag36h11"}, {"a-b"}, {0.1}, "a4", {}}, "no range"},
        BadOrder{"EmptyIds", {{"tag36h11"}, {""}, {0.1}, "a4", {}}, "no range"},
        BadOrder{"SizeInMm", {{"tag36h11"}, {"0"}, {160}, "a4", {}}, "within"},
        BadOrder{"SizeNan", {{"tag36h11"}, {"0"}, {std::nan("")}, "a4", {}}, "within"},
        BadOrder{
            "TwoSizesOfOneId", {{"tag36h11"}, {"0-5", "3"}, {0.1, 0.2}, "a4", {}}, "two sizes"},
        BadOrder{
            "IdTwice", {{"tag36h11"}, {"0-5,3"}, {0.1}, "a4", {}}, "tag36h11 3 is named twice"},
        BadOrder{"IdInTwoBatches",
                 {{"tag36h11"}, {"0-5", "3"}, {0.1}, "a4", {}},
                 "tag36h11 3 is named twice"},
        BadOrder{"AllIdsAgainAndAgain",
                 {{"tag36h11"}, {many_ranges()}, {0.1}, "a4", {}},
                 "tag36h11 0 is named twice"},
        BadOrder{"FamilyWithinAnother",
                 {{"aruco_4x4_50", "aruco_4x4_1000"}, {"0", "60"}, {0.1}, "a4", {}},
                 "codes in common"},
        BadOrder{
            "AnotherWithinIt",
            {{"aruco_5x5_1000", "tag36h11", "aruco_5x5_100"}, {"0", "1", "2"}, {0.1}, "a4", {}},
            "codes in common"},
        BadOrder{"PaperForNoPart", {{"tag36h11"}, {"0"}, {0.1}, "54x54", {}}, "small"},
        BadOrder{"TooManySheets", {{"tagstandard52h13"}, {"0-48713"}, {0.16}, "a4", {}}, "sheets"},
        BadOrder{"UnknownPaper", {{"tag36h11"}, {"0"}, {0.1}, "a9", {}}, "--paper"}),
    [](const auto& info) { return info.param.name; });

TEST_F(PrintedMarkers, ThePdfIsNotMarkersToml) {
  const auto printed =
      run_print({{"tag36h11"}, {"0"}, {0.1}, "a4", folder_.path() / "markers.toml"}, out_);
  ASSERT_FALSE(printed);
  EXPECT_EQ(printed.error().kind, ErrorKind::usage);
}

/// One file under two names, be it there or not.
TEST_F(PrintedMarkers, ThePdfIsNoOtherNameOfMarkersToml) {
  const PrintOptions options{{"tag36h11"}, {"0"}, {0.1}, "a4", {}};
  std::filesystem::create_symlink("markers.toml", folder_.path() / "markers.pdf");
  for (const char* before : {"", "[markers]\nfamily = \"tag36h11\"\nsize_m = 0.1\n"}) {
    if (*before != '\0') folder_.write("markers.toml", before);
    const auto printed = print(options);
    ASSERT_FALSE(printed);
    EXPECT_EQ(printed.error().kind, ErrorKind::usage);
    EXPECT_EQ(folder_.read("markers.toml"), before);
  }
  std::filesystem::remove(folder_.path() / "markers.pdf");
  std::filesystem::create_hard_link(folder_.path() / "markers.toml",
                                    folder_.path() / "markers.pdf");
  EXPECT_FALSE(print(options));
}

TEST_F(PrintedMarkers, AMarkersTomlThatLeadsNowhereOrInCirclesIsNoPlaceToWriteTo) {
  for (const char* target : {"elsewhere.toml", "markers.toml"}) {
    std::filesystem::remove(folder_.path() / "markers.toml");
    std::filesystem::create_symlink(target, folder_.path() / "markers.toml");
    EXPECT_FALSE(print({{"tag36h11"}, {"0"}, {0.1}, "a4", {}})) << target;
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "elsewhere.toml"));
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "markers.pdf")) << target;
  }
}

TEST_F(PrintedMarkers, NoSizesAreLeftWithoutTheirSheets) {
  std::filesystem::create_symlink("markers.pdf", folder_.path() / "markers.pdf");
  const auto printed = print({{"tag36h11"}, {"0"}, {0.1}, "a4", {}});
  ASSERT_FALSE(printed);
  EXPECT_EQ(printed.error().kind, ErrorKind::cant_create);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "markers.toml"));
}

TEST_F(PrintedMarkers, AFolderThatIsNotThereIsSaid) {
  const auto printed =
      run_print({{"tag36h11"}, {"0"}, {0.1}, "a4", folder_.path() / "absent/markers.pdf"}, out_);
  ASSERT_FALSE(printed);
  EXPECT_EQ(printed.error().kind, ErrorKind::cant_create);
}

TEST(PrintAdviceCommand, RangesAndRigsAreChecked) {
  std::ostringstream out;
  std::ostringstream notes;
  for (const double range_m : {0.0, 0.09, 201.0, std::nan("")}) {
    const auto advised = run_print_advice({true, "rig.yaml", range_m}, out, notes);
    ASSERT_FALSE(advised);
    EXPECT_EQ(advised.error().kind, ErrorKind::usage);
  }
  const auto without = run_print_advice({true, {}, 5}, out, notes);
  ASSERT_FALSE(without);
  EXPECT_EQ(without.error().kind, ErrorKind::usage);
  const auto absent = run_print_advice({true, "/nowhere/rig.yaml", 5}, out, notes);
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().kind, ErrorKind::no_input);
}

TEST(PrintAdviceCommand, WhatTheRigsFileSaysIsTold) {
  const test::TemporaryFolder folder;
  const auto rig = folder.write("rig.yaml", tiny_rig_yaml(1) + "  lens: wide\n");
  std::ostringstream out;
  std::ostringstream notes;
  ASSERT_TRUE(run_print_advice({true, rig, 5}, out, notes));
  EXPECT_NE(notes.str().find("lens: unknown key, not used"), std::string::npos) << notes.str();
}

}  // namespace
}  // namespace waymark
