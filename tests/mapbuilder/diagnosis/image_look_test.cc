#include "mapbuilder/diagnosis/image_look.h"

#include <gtest/gtest.h>

#include "core/capture/image_file.h"
#include "mapbuilder/observations/detect_capture.h"
#include "tests/support/printed_wall.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

/// A camera's images of a wall, opened and searched.
struct Walked {
  Walked(const test::Print& print, int images) {
    folder.write("markers.toml", "[markers]\nfamily = \"tag36h11\"\nsize_m = 0.2\n");
    folder.write("rig.yaml",
                 "cam0:\n  camera_model: pinhole\n  intrinsics: "
                 "[600, 600, 319.5, 239.5]\n"
                 "  distortion_model: none\n  distortion_coeffs: "
                 "[]\n  resolution: [640, 480]\n");
    std::filesystem::create_directory(folder.path() / "cam0");
    for (int i = 0; i < images; ++i) {
      const auto name = std::to_string(1'700'000'000'000'000'000 + 1'000'000'000LL * i) + ".pgm";
      EXPECT_TRUE(
          write_gray_image(folder.path() / "cam0" / name, test::wall_with(print, i).view()));
    }
    capture = *open_capture_folder(folder.path());
    detected = *detect_capture(capture, {}, progress, report);
  }

  [[nodiscard]] CameraLook look(int threads = 1) {
    auto looks = look_at_images(capture, detected, threads, progress);
    EXPECT_EQ(looks.size(), 1U);
    return looks.at(0);
  }

  test::TemporaryFolder folder;
  Progress progress{false};
  DetectionReport report;
  CaptureFolder capture;
  DetectedCapture detected;
};

TEST(ImageLook, AFewImagesDoWhereMarkersAreFound) {
  const CameraLook look = Walked({}, 6).look();
  EXPECT_EQ(look.camera, "cam0");
  EXPECT_EQ(look.images, 4U);
  EXPECT_EQ(look.stated, 4 * 8);
  EXPECT_EQ(look.stated_cut, 0);
  EXPECT_EQ(look.upside_down, 0);
  EXPECT_TRUE(look.unlisted.empty());
  for (const auto& [form, count] : look.others) {
    EXPECT_EQ(count.squares, 0) << name_of(form.form.family);
  }
}

TEST(ImageLook, MoreAreLookedAtWhereNothingIsFoundAndThreadsChangeNothing) {
  test::Print print;
  print.family = Family::tag25h9;
  Walked walked(print, 13);
  const CameraLook look = walked.look();
  EXPECT_EQ(look.images, 12U);
  EXPECT_EQ(look.stated, 0);
  const FormCount& count = look.others.at({{Family::tag25h9, false, false}, false, false});
  EXPECT_EQ(count.squares, 12 * 8);
  EXPECT_EQ(count.numbers.size(), 8U);
  const CameraLook again = walked.look(2);
  EXPECT_EQ(again.squares, look.squares);
  EXPECT_EQ(again.mean_grey, look.mean_grey);
}

TEST(ImageLook, DetectionsFromAFileThatHoldMarkersNeedNoLook) {
  Walked walked({}, 2);
  walked.capture.detections_csv = walked.folder.path() / "detections.csv";
  EXPECT_EQ(walked.look().images, 0U);
}

}  // namespace
}  // namespace waymark
