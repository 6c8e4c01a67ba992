#include "mapbuilder/import/video_source.h"

#include <gmock/gmock.h>

#include <opencv2/videoio.hpp>

#include "core/camera/kalibr.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Grey level of a test video's frame, far enough from its neighbours' for the codec.
int gray_level(int frame) { return 10 + 20 * frame; }

class VideoInput : public testing::Test {
 protected:
  /// A Motion JPEG video of 64×48 px; frame i is evenly gray_level(i).
  [[nodiscard]] fs::path make_video(const char* name, int frames, double fps) const {
    const fs::path path = folder_.path() / name;
    cv::VideoWriter writer(path.string(), cv::CAP_OPENCV_MJPEG,
                           cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), fps, cv::Size(64, 48));
    EXPECT_TRUE(writer.isOpened());
    for (int i = 0; i < frames; ++i) {
      writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(gray_level(i))));
    }
    return path;
  }

  [[nodiscard]] static Rig rig(int cameras) {
    return parse_camchain(tiny_rig_yaml(cameras), "rig.yaml")->rig;
  }

  /// Reads to the end.
  static std::vector<VideoFrame> frames_of(VideoSource& source) {
    std::vector<VideoFrame> frames;
    for (;;) {
      auto frame = source.next();
      EXPECT_TRUE(frame) << frame.error().message;
      if (!frame || !*frame) return frames;
      frames.push_back(std::move(**frame));
    }
  }

  static void expect_failure(const Expected<std::unique_ptr<VideoSource>>& source, ErrorKind kind,
                             const char* message) {
    ASSERT_FALSE(source) << "expected: " << message;
    EXPECT_EQ(source.error().kind, kind) << source.error().message;
    EXPECT_THAT(source.error().message, HasSubstr(message));
    EXPECT_EQ(source.error().message.find('\n'), std::string::npos);
  }

  TemporaryFolder folder_;
};

TEST_F(VideoInput, YieldsFramesWithTheContainersStamps) {
  auto source = open_videos({make_video("a.avi", 8, 25)}, rig(1), {});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->expected_frames(), 8U);
  const auto frames = frames_of(**source);
  ASSERT_EQ(frames.size(), 8U);
  for (int i = 0; i < 8; ++i) {
    const VideoFrame& frame = frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(frame.camera, 0);
    EXPECT_EQ(frame.stamp, milliseconds(40 * i));
    EXPECT_EQ(frame.image.width_px, 64);
    EXPECT_EQ(frame.image.height_px, 48);
    EXPECT_NEAR(frame.image.row(20)[30], gray_level(i), 4);
  }
  EXPECT_THAT((*source)->notes(), IsEmpty());
  EXPECT_FALSE(*(*source)->next()) << "stays at the end";
}

TEST_F(VideoInput, FramesThatTheCodecDelaysKeepTheirStamps) {
  const fs::path path = folder_.path() / "a.mp4";
  {
    cv::VideoWriter writer(path.string(), cv::CAP_FFMPEG,
                           cv::VideoWriter::fourcc('a', 'v', 'c', '1'), 25, cv::Size(64, 48));
    ASSERT_TRUE(writer.isOpened());
    for (int i = 0; i < 12; ++i) {
      writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(gray_level(i))));
    }
  }
  auto source = open_videos({path}, rig(1), {});
  ASSERT_TRUE(source) << source.error().message;
  const auto frames = frames_of(**source);
  ASSERT_EQ(frames.size(), 12U);
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(frames[static_cast<std::size_t>(i)].stamp, milliseconds(40 * i));
    EXPECT_NEAR(frames[static_cast<std::size_t>(i)].image.row(20)[30], gray_level(i), 8);
  }
}

TEST_F(VideoInput, TakesOneOfEveryFew) {
  auto source = open_videos({make_video("a.avi", 8, 25)}, rig(1), {.every = 3});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->expected_frames(), 3U);
  const auto frames = frames_of(**source);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[1].stamp, milliseconds(120));
  EXPECT_NEAR(frames[2].image.row(0)[0], gray_level(6), 4);
}

TEST_F(VideoInput, SynchronizedVideosMeetByStampThenCamera) {
  auto source = open_videos({make_video("a.avi", 3, 25), make_video("b.avi", 5, 50)}, rig(2),
                            {.synchronized = true});
  ASSERT_TRUE(source) << source.error().message;
  std::vector<std::pair<int, int>> order;  // ms, camera
  for (const VideoFrame& frame : frames_of(**source)) {
    order.emplace_back(static_cast<int>(frame.stamp / milliseconds(1)), frame.camera);
  }
  EXPECT_THAT(order,
              ElementsAre(std::pair(0, 0), std::pair(0, 1), std::pair(20, 1), std::pair(40, 0),
                          std::pair(40, 1), std::pair(60, 1), std::pair(80, 0), std::pair(80, 1)));
}

TEST_F(VideoInput, UsageIsChecked) {
  const fs::path a = make_video("a.avi", 2, 25);
  expect_failure(open_videos({a}, rig(1), {.every = 0}), ErrorKind::usage, "--every 0");
  expect_failure(open_videos({a}, rig(2), {.synchronized = true}), ErrorKind::usage,
                 "1 videos, but the rig has 2 cameras");
  expect_failure(open_videos({}, rig(1), {}), ErrorKind::usage, "0 videos");
  expect_failure(open_videos({a, a}, rig(2), {}), ErrorKind::usage, "give --sync");
}

TEST_F(VideoInput, WhatIsNoVideoIsRefused) {
  expect_failure(open_videos({folder_.path() / "absent.avi"}, rig(1), {}), ErrorKind::no_input,
                 "absent.avi: no such video file");
  expect_failure(open_videos({folder_.path()}, rig(1), {}), ErrorKind::no_input,
                 "no such video file");
  for (const char* content : {"", "hello\n"}) {
    testing::internal::CaptureStderr();
    expect_failure(open_videos({folder_.write("no.avi", content)}, rig(1), {}), ErrorKind::bad_data,
                   "no.avi: ");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "the library may not print";
  }
}

TEST_F(VideoInput, FramesOfAnotherSizeAreRefused) {
  Rig other = rig(1);
  CameraParameters parameters = other.cameras[0].model.parameters();
  parameters.width_px = 65;
  other.cameras[0].model = *CameraModel::create(parameters);
  expect_failure(open_videos({make_video("a.avi", 2, 25)}, other, {}), ErrorKind::bad_data,
                 "the video is 64×48, rig.yaml says 65×48");
}

TEST_F(VideoInput, TruncatedVideoYieldsWhatIsThereAndSaysSo) {
  const fs::path whole = make_video("a.avi", 8, 25);
  fs::resize_file(whole, fs::file_size(whole) / 2);
  testing::internal::CaptureStderr();
  auto source = open_videos({whole}, rig(1), {});
  ASSERT_TRUE(source) << source.error().message;
  const auto frames = frames_of(**source);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "the library may not print";
  EXPECT_GE(frames.size(), 1U);
  EXPECT_LT(frames.size(), 8U);
  EXPECT_THAT((*source)->notes(), ElementsAre(HasSubstr("is the file cut off?")));
}

}  // namespace
}  // namespace waymark
