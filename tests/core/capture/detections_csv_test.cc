#include "core/capture/detections_csv.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <random>

#include "core/capture/detections_csv_text.h"
#include "tests/core/capture/csv_of_two_cameras.h"
#include "tests/support/bad_input.h"

namespace waymark {
namespace {

using testing::HasSubstr;

constexpr const char* kHeader = "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\n";

using DetectionsCsv = test::CsvOfTwoCameras;

TEST_F(DetectionsCsv, RowsBecomeImagesWithDetections) {
  const auto table = good(std::string(kHeader) +
                          "1511000000000000001,cam1,12,10.5,11,20,11,20,21,10,21\n"
                          "1511000000000000001,cam1,7,1,1,2,1,2,2,1,2\n"
                          "1511000000000000000,cam0,3,1,1,2,1,2,2,1,2\n");
  ASSERT_EQ(table.images.size(), 2U);
  EXPECT_EQ(table.images[0].stamp.count(), 1511000000000000000);
  EXPECT_EQ(table.images[0].camera, 0);
  EXPECT_EQ(table.images[1].camera, 1);
  ASSERT_EQ(table.images[1].detections.size(), 2U);
  EXPECT_EQ(table.images[1].detections[0].marker, (MarkerId{Family::tag36h11, 7}));
  const Detection& detection = table.images[1].detections[1];
  EXPECT_EQ(detection.marker.number, 12);
  EXPECT_EQ(detection.corners[0], Eigen::Vector2d(10.5, 11));
  EXPECT_EQ(detection.corners[3], Eigen::Vector2d(10, 21));
  EXPECT_EQ(detection.hamming, 0);
  EXPECT_FALSE(detection.covariances);
  EXPECT_TRUE(table.detector.empty());
}

TEST_F(DetectionsCsv, ColumnsAreFoundByNameAndOthersPassedOver) {
  const auto table = good(
      "camera , y3,x3,y2,x2,y1,x1,y0,x0, note,hamming,marker_id,t_ns\n"
      "cam0, 8,1,8,7,2,7,2,1, hello there, 2, 5, -40 \n");
  ASSERT_EQ(table.images.size(), 1U);
  EXPECT_EQ(table.images[0].stamp.count(), -40);
  EXPECT_EQ(table.images[0].detections[0].corners[2], Eigen::Vector2d(7, 8));
  EXPECT_EQ(table.images[0].detections[0].hamming, 2);
}

TEST_F(DetectionsCsv, EmptyMarkerIdIsAnImageWithNothingFound) {
  const auto table = good(std::string(kHeader) + "5,cam0,,,,,,,,,\n");
  ASSERT_EQ(table.images.size(), 1U);
  EXPECT_TRUE(table.images[0].detections.empty());
}

TEST_F(DetectionsCsv, ByteOrderMarkCrlfCommentsAndBlankLinesAreAllowed) {
  const auto table = good(
      "\xEF\xBB\xBF# by hand\r\nt_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\r\n"
      "\r\n5,cam0,3,1,1,2,1,2,2,1,2\r\n# the end");
  ASSERT_EQ(table.images.size(), 1U);
  EXPECT_EQ(table.images[0].detections[0].corners[3], Eigen::Vector2d(1, 2));
}

TEST_F(DetectionsCsv, FamilyFromItsColumnOrTheId) {
  catalog_ = *parse_marker_catalog(
      "[[markers]]\nfamily='tag36h11'\nsize_m=1\n[[markers]]\nfamily='aruco_original'\nsize_m=1\n",
      "markers.toml");
  const auto table = good(
      "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3,family\n"
      "5,cam0,3,1,1,2,1,2,2,1,2,aruco_original\n"
      "5,cam0,tag36h11:3,1,1,2,1,2,2,1,2,\n"
      "5,cam0,tag36h11:4,1,1,2,1,2,2,1,2,tag36h11\n");
  ASSERT_EQ(table.images[0].detections.size(), 3U);
  EXPECT_EQ(table.images[0].detections[0].marker, (MarkerId{Family::aruco_original, 3}));
  EXPECT_EQ(table.images[0].detections[1].marker, (MarkerId{Family::tag36h11, 3}));
  EXPECT_THAT(read(std::string(kHeader) + "5,cam0,3,1,1,2,1,2,2,1,2\n").error().message,
              HasSubstr("several families"));
  EXPECT_THAT(read("t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3,family\n"
                   "5,cam0,tag36h11:4,1,1,2,1,2,2,1,2,aruco_original\n")
                  .error()
                  .message,
              HasSubstr("contradicts"));
}

TEST_F(DetectionsCsv, MarkersThatDoNotExistHereAreLeftOutAndCounted) {
  const auto table = good(std::string(kHeader) +
                          "5,cam0,99,1,1,2,1,2,2,1,2\n"
                          "6,cam0,tag36h10:5,1,1,2,1,2,2,1,2\n"
                          "6,cam0,5,1,1,2,1,2,2,1,2\n");
  EXPECT_EQ(table.unknown_markers, 2);
  int unlisted = 0;
  for (const auto& [id, rows] : table.unlisted) unlisted += rows;
  EXPECT_EQ(unlisted, 1) << "the other one is ignored";
  ASSERT_EQ(table.images.size(), 2U) << "the image itself was seen";
  EXPECT_TRUE(table.images[0].detections.empty());
  EXPECT_EQ(table.images[1].detections.size(), 1U);
}

TEST_F(DetectionsCsv, CornersOfAnotherOrderAreLeftOutAndCounted) {
  const auto table = good(std::string(kHeader) +
                          "5,cam0,1,1,2,2,2,2,1,1,1\n"    // bottom-left first, counter-clockwise
                          "5,cam0,2,1,1,2,2,3,3,4,4\n"    // on one line
                          "5,cam0,3,2,1,2,2,1,2,1,1\n");  // turned by 90°, clockwise
  EXPECT_EQ(table.misordered, 2);
  ASSERT_EQ(table.images[0].detections.size(), 1U);
  EXPECT_EQ(table.images[0].detections[0].marker.number, 3);
}

TEST_F(DetectionsCsv, OrderOfTheRowsLeavesNoTrace) {
  std::mt19937 random(3);
  std::vector<std::string> rows;
  for (int i = 0; i < 200; ++i) {
    const int x = static_cast<int>(random() % 1000);
    rows.push_back(fmt::format("{}0000000,cam{},{},{},1,{},1,{},9,{},9\n", random() % 20,
                               random() % 2, random() % 5, x, x + 8, x + 8, x));
  }
  const auto text_of = [&] { return kHeader + fmt::format("{}", fmt::join(rows, "")); };
  const std::string expected = format_detections_csv(good(text_of()).images, rig_, catalog_, "x");
  for (int round = 0; round < 5; ++round) {
    std::shuffle(rows.begin(), rows.end(), random);
    EXPECT_EQ(format_detections_csv(good(text_of()).images, rig_, catalog_, "x"), expected);
  }
}

TEST_F(DetectionsCsv, StaleFileIsAnError) {
  const std::string text = format_detections_csv({}, rig_, catalog_, "x");
  EXPECT_TRUE(read(text));
  catalog_ = *parse_marker_catalog("[markers]\nfamily='tag36h11'\nsize_m=0.2\n", "markers.toml");
  const auto table = read(text);
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(table.error().message, HasSubstr("stale"));
  EXPECT_TRUE(read(text.substr(text.find('\n') + 1))) << "somebody else's file can't be stale";
}

/// A room's worth of rows: 12 frame sets of two cameras, three markers each.
struct Rows {
  std::function<std::string(int)> stamp = [](int set) {
    return std::to_string(1700000000000000000 + set * 100000000LL);
  };
  std::array<std::array<int, 2>, 4> corners{{{10, 10}, {20, 10}, {20, 20}, {10, 20}}};
  std::string separator = ",";
  std::string point = ".";
  int copies = 1;

  [[nodiscard]] std::string text() const {
    std::string text =
        fmt::format("{}\n", fmt::join(std::vector{"t_ns", "camera", "marker_id", "x0", "y0", "x1",
                                                  "y1", "x2", "y2", "x3", "y3"},
                                      separator));
    for (int set = 0; set < 12; ++set) {
      for (int camera = 0; camera < 2; ++camera) {
        for (int marker = 0; marker < 3; ++marker) {
          std::vector<std::string> fields{stamp(set), fmt::format("cam{}", camera),
                                          fmt::format("{}", marker)};
          for (const auto& [x, y] : corners) {
            fields.push_back(fmt::format("{}{}{}", x + 12 * marker, point, set));
            fields.push_back(fmt::format("{}{}5", y, point));
          }
          for (int copy = 0; copy < copies; ++copy) {
            text += fmt::format("{}\n", fmt::join(fields, separator));
          }
        }
      }
    }
    return text;
  }
};

/// Tables as other programs write them: refused in one line that recognizes them.
class ForeignTable : public DetectionsCsv {
 protected:
  void expect_recognized(const std::string& text, Cause cause, const char* message) const {
    const auto table = read(text);
    ASSERT_FALSE(table) << message;
    EXPECT_EQ(table.error().kind, ErrorKind::bad_data);
    EXPECT_EQ(table.error().cause, cause) << table.error().message;
    EXPECT_THAT(table.error().message, HasSubstr("detections.csv: "));
    EXPECT_THAT(table.error().message, HasSubstr(message));
    EXPECT_EQ(table.error().message.find('\n'), std::string::npos);
  }

  static std::string utf16(std::string_view text, bool little_endian, bool with_mark) {
    std::string wide = with_mark ? (little_endian ? "\xFF\xFE" : "\xFE\xFF") : "";
    for (const char c : text) wide += little_endian ? std::string{c, '\0'} : std::string{'\0', c};
    return wide;
  }
};

TEST_F(ForeignTable, ARoomInOurFormatIsTaken) { EXPECT_EQ(good(Rows{}.text()).images.size(), 24U); }

TEST_F(ForeignTable, OtherSeparators) {
  const std::pair<const char*, const char*> variants[] = {
      {";", "separated by \";\""}, {"\t", "separated by tabs"}, {"|", "separated by \"|\""}};
  for (const auto& [separator, message] : variants) {
    for (const char* point : {".", ","}) {
      expect_recognized(Rows{.separator = separator, .point = point}.text(), Cause::csv, message);
    }
  }
  expect_recognized(Rows{.point = ","}.text(), Cause::csv, "decimal commas");
  expect_recognized("\"t_ns\",\"camera\"\n", Cause::csv, "in quotes");
}

TEST_F(ForeignTable, OtherEncodings) {
  for (const bool little_endian : {true, false}) {
    for (const bool with_mark : {true, false}) {
      expect_recognized(utf16(Rows{}.text(), little_endian, with_mark), Cause::csv, "UTF-16");
    }
  }
}

TEST_F(ForeignTable, StampsInOtherUnits) {
  const auto in = [](std::int64_t per_second, double fraction_of_s) {
    return Rows{.stamp =
                    [=](int set) {
                      const double s = 1700000000.0 + set * fraction_of_s;
                      return fmt::format("{:.0f}", s * static_cast<double>(per_second));
                    }}
        .text();
  };
  for (const double apart_s : {0.0333, 0.1, 0.5, 2.0}) {
    expect_recognized(in(1'000'000, apart_s), Cause::stamps, "look like µs");
    expect_recognized(in(1'000, apart_s), Cause::stamps, "look like ms");
  }
  expect_recognized(in(1, 1.0), Cause::stamps, "look like s");
  expect_recognized(Rows{.stamp = [](int set) { return fmt::format("1700000000.{}", set); }}.text(),
                    Cause::stamps, "in s?");
  for (const char* rounded : {"1.70000E+18", "1.7e18", "1.70000000000E+18"}) {
    expect_recognized(Rows{.stamp = [=](int) { return rounded; }}.text(), Cause::stamps,
                      "rounded by a spreadsheet");
  }
}

TEST_F(ForeignTable, StampsThatAreNone) {
  for (const int first : {0, 1, 5000}) {
    for (const int step : {1, 10}) {
      expect_recognized(
          Rows{.stamp = [=](int set) { return fmt::format("{}", first + step * set); }}.text(),
          Cause::stamps, "frame numbers");
    }
  }
  for (const char* same : {"0", "1700000000000000000"}) {
    expect_recognized(Rows{.stamp = [=](int) { return same; }}.text(), Cause::stamps,
                      fmt::format("all stamps are {}", same).c_str());
  }
  expect_recognized(
      Rows{.stamp = [](int set) { return set % 2 == 0 ? std::string("0") : Rows{}.stamp(set); }}
          .text(),
      Cause::stamps, "stamps are 0, the others like");
  for (const char* far : {"9223372036854775807", "-9223372036854775808", "4611686018427387904"}) {
    expect_recognized(Rows{.stamp = [=](int) { return far; }}.text(), Cause::stamps, "146 years");
  }
}

TEST_F(ForeignTable, StampsOfAnyEpochAreTaken) {
  const std::function<std::string(int)> variants[] = {
      [](int set) { return fmt::format("{}", set * 33'333'333LL); },
      [](int set) { return fmt::format("{}", set * 33'333'333LL - 100'000'000); },
      [](int set) { return fmt::format("{}", 1'700'000'000'000LL + set * 1'000'000LL); },
      [](int set) { return fmt::format("{}", 1'700'000'000'000'000LL + set * 33'333'333LL); }};
  for (const auto& stamp : variants) EXPECT_TRUE(read(Rows{.stamp = stamp}.text())) << stamp(1);
  EXPECT_TRUE(read(std::string(kHeader) + "0,cam0,3,1,1,2,1,2,2,1,2\n0,cam1,3,1,1,2,1,2,2,1,2\n"));
}

TEST_F(ForeignTable, RowsTwice) {
  expect_recognized(Rows{.copies = 2}.text(), Cause::csv, "every row stands twice");
}

TEST_F(ForeignTable, CornersInAnotherOrder) {
  using Corners = std::array<std::array<int, 2>, 4>;
  const std::pair<Corners, const char*> variants[] = {
      {Corners{{{10, 20}, {20, 20}, {20, 10}, {10, 10}}}, "apriltag library"},
      {Corners{{{10, 37}, {20, 37}, {20, 27}, {10, 27}}}, "height - 1 - y"},
      {Corners{{{20, 10}, {10, 10}, {10, 20}, {20, 20}}}, "counter-clockwise"},
      {Corners{{{10, 10}, {20, 10}, {10, 20}, {20, 20}}}, "crosses itself"},
  };
  for (const auto& [corners, message] : variants) {
    expect_recognized(Rows{.corners = corners}.text(), Cause::csv, message);
  }
  const Corners turned{{{20, 20}, {10, 20}, {10, 10}, {20, 10}}};
  EXPECT_TRUE(read(Rows{.corners = turned}.text())) << "a marker may hang upside down";
}

TEST_F(DetectionsCsv, MemoryIsBoundedBeforeALineOrTheFileIsTaken) {
  EXPECT_THAT(read(std::string(kHeader) + std::string(200'000, ',')).error().message,
              HasSubstr("line 2 has more than 65536 bytes"));
  EXPECT_THAT(read(kHeader + std::string(64, ',')).error().message,
              HasSubstr("line 2: more than 64 columns"));
  EXPECT_THAT(read(std::string(100, ',') + "\n").error().message,
              HasSubstr("line 1: more than 64 columns"));
  // On the other side of both limits: 64 columns, and a line of 64 KiB.
  std::string header(kHeader, std::string_view(kHeader).size() - 1);
  for (int column = 11; column < 64; ++column) header += fmt::format(",note{}", column);
  const std::string row = "5,cam0,3,1,1,2,1,2,2,1,2" + std::string(53, ',');
  EXPECT_TRUE(read(header + "\n" + row + std::string(65536 - row.size(), 'x') + "\n"));
  const auto file = folder_.write("detections.csv", kHeader);
  const auto refusal_of = [&](std::uintmax_t bytes) {
    std::filesystem::resize_file(file, bytes);
    const auto table = read_detections_csv(file, rig_, catalog_);
    return table ? "accepted" : table.error().message;
  };
  EXPECT_THAT(refusal_of(std::uintmax_t{4} << 30), HasSubstr("sparse"));
  EXPECT_THAT(refusal_of((std::uintmax_t{4} << 30) + 1), HasSubstr("larger than"));
}

TEST_F(DetectionsCsv, AbsentFileIsNoInput) {
  EXPECT_EQ(read_detections_csv(folder_.path() / "absent.csv", rig_, catalog_).error().kind,
            ErrorKind::no_input);
}

TEST_F(DetectionsCsv, TwentyThousandRowsTakeNoTime) {
  std::string text = kHeader;
  for (int i = 0; i < 20'000; ++i) {
    text += fmt::format("{},cam0,{},100.1234,100.5,200.25,100.75,200.125,200.5,100.0625,200.1\n",
                        1511000000000000000 + i / 20 * 1000000, i % 500 + i % 2);
  }
  folder_.write("many.csv", text);
  const auto start = std::chrono::steady_clock::now();
  const auto table = read_detections_csv(folder_.path() / "many.csv", rig_, catalog_);
  const auto took = std::chrono::steady_clock::now() - start;
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ(table->images.size(), 1000U);
  // About 30 ms in release; the bound allows for sanitizers and a busy machine.
  EXPECT_LT(took, std::chrono::seconds(3));
}

class BadDetectionsCsv : public DetectionsCsv, public testing::WithParamInterface<BadInput> {};

TEST_P(BadDetectionsCsv, IsRefusedInOneLine) {
  const auto table = read(GetParam().text);
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(table.error().message, HasSubstr("detections.csv: "));
  EXPECT_THAT(table.error().message, HasSubstr(GetParam().message));
  EXPECT_EQ(table.error().message.find('\n'), std::string::npos);
}

#define HEADER "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3"
#define COVARIANCES ",sxx0,sxy0,syy0,sxx1,sxy1,syy1,sxx2,sxy2,syy2,sxx3,sxy3,syy3"
#define CORNERS "1,1,2,1,2,2,1,2"

INSTANTIATE_TEST_SUITE_P(
    Cases, BadDetectionsCsv,
    testing::Values(
        BadInput{"Empty", "", "empty; its first row must name the columns"},
        BadInput{"CommentsOnly", "# nothing\n", "empty"},
        BadInput{"NoHeader", "5,cam0,3," CORNERS "\n", "no column \"t_ns\""},
        BadInput{"MissingColumn", "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3\n",
                 "line 1: no column \"y3\""},
        BadInput{"MissingCovarianceColumn", HEADER ",sxx0,sxy0\n", "no column \"syy0\""},
        BadInput{"DoubledColumn", HEADER ",x0\n", "column \"x0\" stands twice"},
        BadInput{"StampNoNumber", HEADER "\n5,cam0,,,,,,,,,\nnow,cam0,3," CORNERS "\n",
                 "line 3: t_ns \"now\""},
        BadInput{"StampWithFraction", HEADER "\n5.5,cam0,3," CORNERS "\n", "t_ns \"5.5\""},
        BadInput{"StampTooLarge", HEADER "\n99999999999999999999,cam0,3," CORNERS "\n", "t_ns"},
        BadInput{"StampEmpty", HEADER "\n,cam0,3," CORNERS "\n", "t_ns \"\""},
        BadInput{"UnknownCamera", HEADER "\n5,cam7,3," CORNERS "\n",
                 "camera \"cam7\" is not in rig.yaml"},
        BadInput{"MarkerNoNumber", HEADER "\n5,cam0,three," CORNERS "\n", "\"three\""},
        BadInput{"MarkerNegative", HEADER "\n5,cam0,-1," CORNERS "\n", "\"-1\""},
        BadInput{"MarkerOutsideFamily", HEADER "\n5,cam0,587," CORNERS "\n", "0 to 586"},
        BadInput{"UnknownFamily", HEADER ",family\n5,cam0,3," CORNERS ",tag99\n",
                 "unknown family \"tag99\""},
        BadInput{"NanCorner", HEADER "\n5,cam0,3,nan,1,2,1,2,2,1,2\n",
                 "line 2: x0 \"nan\" is no pixel coordinate"},
        BadInput{"InfiniteCorner", HEADER "\n5,cam0,3,1,1,2,1,2,-inf,1,2\n", "y2 \"-inf\""},
        BadInput{"HugeCorner", HEADER "\n5,cam0,3,1,1,2,1,2,2,1,1e300\n", "y3 \"1e300\""},
        BadInput{"EmptyCorner", HEADER "\n5,cam0,3,1,1,2,1,2,2,1,\n", "y3 \"\""},
        BadInput{"CornerNoNumber", HEADER "\n5,cam0,3,1,1,2,1,2,2,1,2px\n", "y3 \"2px\""},
        BadInput{"ShortRow", HEADER "\n5,cam0,3,1,1,2,1\n", "line 2: 7 fields where the header"},
        BadInput{"LongRow", HEADER "\n5,cam0,3," CORNERS ",9\n", "12 fields"},
        BadInput{"HammingNegative", HEADER ",hamming\n5,cam0,3," CORNERS ",-1\n", "hamming \"-1\""},
        BadInput{"CovarianceNan",
                 HEADER COVARIANCES "\n5,cam0,3," CORNERS ",nan,0,1,1,0,1,1,0,1,1,0,1\n",
                 "sxx0 \"nan\""},
        BadInput{"CovarianceNegative",
                 HEADER COVARIANCES "\n5,cam0,3," CORNERS ",1,0,1,-1,0,1,1,0,1,1,0,1\n",
                 "covariance of corner 1"},
        BadInput{"CovarianceIndefinite",
                 HEADER COVARIANCES "\n5,cam0,3," CORNERS ",1,0,1,1,0,1,1,0,1,1,1.01,1\n",
                 "covariance of corner 3"},
        BadInput{"CovarianceHalfEmpty",
                 HEADER COVARIANCES "\n5,cam0,3," CORNERS ",1,0,1,1,0,1,1,0,1,1,,1\n", "sxy3 \"\""},
        BadInput{"Binary", "\x7F\x45LF\x01\x02\n\x03", "no column \"t_ns\""}),
    bad_input_name);

}  // namespace
}  // namespace waymark
