#include "mapbuilder/observations/detect_capture.h"

#include <gmock/gmock.h>

#include "core/capture/detections_csv_text.h"
#include "core/capture/image_file.h"
#include "tests/support/marker_scene.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class DetectCapture : public ::testing::Test {
 protected:
  DetectCapture() {
    folder_.write("rig.yaml", scene_rig_yaml());
    folder_.write("markers.toml", scene_markers_toml());
    std::filesystem::create_directory(folder_.path() / "cam0");
  }

  void add_image(const std::string& name, int step = 0) const {
    ASSERT_TRUE(write_gray_image(folder_.path() / "cam0" / name, scene_image(step).view()));
  }

  /// Opens the capture anew and detects.
  Expected<DetectedCapture> detect(const DetectCaptureOptions& options = {}) {
    const auto capture = open_capture_folder(folder_.path());
    if (!capture) return tl::make_unexpected(capture.error());
    report_ = {};
    return detect_capture(*capture, options, progress_, report_);
  }

  TemporaryFolder folder_;
  Progress progress_{false};
  DetectionReport report_;
};

TEST_F(DetectCapture, FindsTheMarkersOfEveryImage) {
  add_image("10.png");
  add_image("20.pgm", 5);
  const auto detected = detect();
  ASSERT_TRUE(detected) << detected.error().message;
  ASSERT_EQ(detected->images.size(), 2U);
  for (const ImageDetections& image : detected->images) {
    ASSERT_EQ(image.detections.size(), 2U);
    EXPECT_EQ(image.detections[0].marker.number, 1);
    EXPECT_EQ(image.detections[1].marker.number, 2);
    EXPECT_TRUE(image.detections[0].covariances);
  }
  EXPECT_EQ(detected->images[1].stamp.count(), 20);
  EXPECT_NEAR(detected->images[1].detections[0].corners[0].x() -
                  detected->images[0].detections[0].corners[0].x(),
              5, 0.5);
  EXPECT_EQ(report_.images, 2U);
  EXPECT_EQ(report_.detections, 4U);
  EXPECT_FALSE(report_.from_csv);
  EXPECT_THAT(report_.warnings, IsEmpty());
}

TEST_F(DetectCapture, ThreadsChangeNothing) {
  for (int i = 0; i < 6; ++i) add_image(std::to_string(10 + i) + ".pgm", 3 * i);
  const auto one = detect({false, 1});
  const auto three = detect({false, 3});
  ASSERT_TRUE(one && three);
  EXPECT_EQ(format_detections_csv(one->images, one->rig, one->catalog, "x"),
            format_detections_csv(three->images, three->rig, three->catalog, "x"));
}

TEST_F(DetectCapture, EveryEngineFindsTheMarkersThatItKnows) {
  add_image("10.png");
  for (const DetectorEngine engine :
       {DetectorEngine::own, DetectorEngine::opencv, DetectorEngine::apriltag}) {
    const auto detected = detect({.engine = engine});
    ASSERT_TRUE(detected) << detected.error().message;
    EXPECT_EQ(report_.detections, 2U) << name_of(engine);
  }
}

TEST_F(DetectCapture, OneBadImageIsSkippedAndCounted) {
  add_image("10.png");
  folder_.write("cam0/20.png", folder_.read("cam0/10.png").substr(0, 500));
  folder_.write("cam0/30.jpg", "not an image");
  folder_.write("cam0/40.jpg", "");
  ASSERT_TRUE(write_gray_image(folder_.path() / "cam0/50.pgm", GrayImage(321, 240).view()));
  const auto detected = detect();
  ASSERT_TRUE(detected) << detected.error().message;
  EXPECT_EQ(detected->images.size(), 1U);
  EXPECT_EQ(report_.images, 5U);
  EXPECT_EQ(report_.unreadable, 4U);
  EXPECT_THAT(report_.warnings,
              ElementsAre(HasSubstr("20.png: damaged or truncated PNG"),
                          HasSubstr("30.jpg: no image"), HasSubstr("40.jpg: empty file"),
                          HasSubstr("50.pgm: the image is 321×240, rig.yaml says 320×240")));
}

TEST_F(DetectCapture, NotOneUsableImageIsBadData) {
  folder_.write("cam0/10.png", "not an image");
  const auto detected = detect();
  ASSERT_FALSE(detected);
  EXPECT_EQ(detected.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(detected.error().message, HasSubstr("none of 1 images could be used"));
  EXPECT_THAT(detected.error().message, HasSubstr("10.png"));
}

TEST_F(DetectCapture, SixteenBitImagesAreSaid) {
  const GrayImage image = scene_image(0);
  std::string pgm = "P5 320 240 65535\n";
  for (const std::uint8_t pixel : image.pixels) {
    pgm += static_cast<char>(pixel);
    pgm += '\x7F';
  }
  folder_.write("cam0/10.pgm", pgm);
  const auto detected = detect();
  ASSERT_TRUE(detected) << detected.error().message;
  EXPECT_EQ(detected->images[0].detections.size(), 2U);
  EXPECT_THAT(report_.warnings, Contains(HasSubstr("1 images have 16 bits; the upper 8 are used")));
}

TEST_F(DetectCapture, BitsInTheLowEndOfSixteenAreReadAndSaid) {
  for (const int bits : {10, 12, 14}) {
    std::string pgm = "P5 320 240 65535\n";
    for (const std::uint8_t pixel : scene_image(0).pixels) {
      const int value = pixel << (bits - 8);
      pgm += static_cast<char>(value >> 8);
      pgm += static_cast<char>(value);
    }
    folder_.write("cam0/10.pgm", pgm);
    const auto detected = detect();
    ASSERT_TRUE(detected) << detected.error().message;
    EXPECT_EQ(detected->images[0].detections.size(), 2U);
    EXPECT_THAT(report_.warnings,
                Contains(HasSubstr(fmt::format("of 65535: {} bits in the low end", bits))));
  }
}

TEST_F(DetectCapture, ImagesInAFormatThatIsNotReadAreACause) {
  folder_.write("cam0/10.png", std::string("II*\0\0\0\0\0", 8));
  const auto detected = detect();
  ASSERT_FALSE(detected);
  EXPECT_EQ(detected.error().cause, Cause::format);
  EXPECT_THAT(detected.error().message, HasSubstr("10.png: a TIFF image"));
}

TEST_F(DetectCapture, AnImageWithoutMarkersWasSeen) {
  ASSERT_TRUE(write_gray_image(folder_.path() / "cam0/10.pgm", GrayImage(320, 240, 90).view()));
  const auto detected = detect();
  ASSERT_TRUE(detected) << detected.error().message;
  ASSERT_EQ(detected->images.size(), 1U);
  EXPECT_THAT(detected->images[0].detections, IsEmpty());
}

TEST_F(DetectCapture, DetectionsCsvBeatsImagesUnlessToldOtherwise) {
  add_image("10.png");
  folder_.write("detections.csv",
                "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\n"
                "1000000000,cam0,7,10,10,60,10,60,60,10,60\n"
                "1100000000,cam0,8,60,10,10,10,10,60,60,60\n"
                "1200000000,cam0,tag25h9:3,10,10,60,10,60,60,10,60\n");
  const auto from_csv = detect();
  ASSERT_TRUE(from_csv) << from_csv.error().message;
  EXPECT_TRUE(report_.from_csv);
  EXPECT_EQ(report_.detections, 1U);
  EXPECT_EQ(from_csv->images[0].detections[0].marker.number, 7);
  EXPECT_THAT(report_.warnings, ElementsAre(HasSubstr("1 rows left out, markers.toml"),
                                            HasSubstr("1 rows left out, their corners")));
  const auto from_images = detect({true, 0});
  ASSERT_TRUE(from_images);
  ASSERT_EQ(from_images->images[0].detections.size(), 2U);
  EXPECT_EQ(from_images->images[0].detections[0].marker.number, 1);
}

TEST_F(DetectCapture, BadDetectionsCsvIsBadData) {
  folder_.write("detections.csv", "t_ns,camera\n");
  const auto detected = detect();
  ASSERT_FALSE(detected);
  EXPECT_EQ(detected.error().kind, ErrorKind::bad_data);
}

}  // namespace
}  // namespace waymark
