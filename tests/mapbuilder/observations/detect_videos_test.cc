#include "mapbuilder/observations/detect_videos.h"

#include <gmock/gmock.h>

#include "core/capture/detections_csv_text.h"
#include "tests/support/marker_scene.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/video_writer.h"

namespace waymark {
namespace {

using ::testing::HasSubstr;

class DetectVideos : public ::testing::Test {
 protected:
  /// Six frames, 25 Hz; the camera moves 4 px from frame to frame.
  void SetUp() override {
    capture_.rig_yaml = folder_.write("rig.yaml", scene_rig_yaml());
    capture_.markers_toml = folder_.write("markers.toml", scene_markers_toml());
    capture_.videos = {folder_.path() / "cam0.avi"};
    test::VideoWriter writer(capture_.videos.front());
    for (int i = 0; i < 6; ++i) writer.write(scene_image(4 * i).view(), i);
  }

  Expected<DetectedCapture> detect(int threads = 0) {
    report_ = {};
    return detect_videos(capture_, {.threads = threads}, progress_, report_);
  }

  TemporaryFolder folder_;
  VideoCapture capture_;
  Progress progress_{false};
  DetectionReport report_;
};

TEST_F(DetectVideos, FindsTheMarkersOfEveryFrameThatCounts) {
  capture_.options.every = 2;
  const auto detected = detect();
  ASSERT_TRUE(detected) << detected.error().message;
  ASSERT_EQ(detected->images.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(detected->images[i].stamp, std::chrono::milliseconds(80 * i));
    ASSERT_EQ(detected->images[i].detections.size(), 2U);
    EXPECT_EQ(detected->images[i].detections[1].marker, (MarkerId{Family::tag36h11, 2}));
  }
  EXPECT_NEAR(detected->images[2].detections[0].corners[0].x() -
                  detected->images[0].detections[0].corners[0].x(),
              16, 0.5);
  EXPECT_EQ(report_.images, 3U);
  EXPECT_EQ(report_.detections, 6U);
}

TEST_F(DetectVideos, ThreadsChangeNothing) {
  const auto one = detect(1);
  const auto three = detect(3);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(format_detections_csv(one->images, one->rig, one->catalog, "x"),
            format_detections_csv(three->images, three->rig, three->catalog, "x"));
}

TEST_F(DetectVideos, BadInputIsRefused) {
  const auto expect_failure = [&](ErrorKind kind, const char* message) {
    const auto detected = detect();
    ASSERT_FALSE(detected) << "expected: " << message;
    EXPECT_EQ(detected.error().kind, kind);
    EXPECT_THAT(detected.error().message, HasSubstr(message));
  };
  capture_.videos.push_back(capture_.videos.front());
  expect_failure(ErrorKind::usage, "2 videos, but the rig has 1 cameras");
  capture_.videos = {folder_.path() / "absent.avi"};
  expect_failure(ErrorKind::no_input, "absent.avi");
  capture_.markers_toml = folder_.path() / "absent.toml";
  expect_failure(ErrorKind::no_input, "absent.toml");
  capture_.rig_yaml = folder_.path() / "absent.yaml";
  expect_failure(ErrorKind::no_input, "absent.yaml");
}

}  // namespace
}  // namespace waymark
