#include "mapbuilder/import/video_source.h"

#include <gmock/gmock.h>

#include <set>

#include "core/camera/kalibr.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_pattern.h"
#include "tests/support/tiny_capture.h"
#include "tests/support/video_writer.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Grey level of a test video's frame, far enough from its neighbours' for the codec.
int gray_level(int frame) { return 10 + 20 * (frame % 12); }

class VideoInput : public testing::Test {
 protected:
  /// A Motion JPEG video of 64×48 px; frame i is evenly gray_level(i) and `lost` are left out.
  [[nodiscard]] fs::path make_video(const char* name, int frames, int rate_hz,
                                    const std::set<int>& lost = {}) const {
    const fs::path path = folder_.path() / name;
    test::VideoWriter writer(path, {.rate_hz = rate_hz});
    for (int i = 0; i < frames; ++i) {
      if (lost.contains(i)) continue;
      writer.write(GrayImage(64, 48, static_cast<std::uint8_t>(gray_level(i))).view(), i);
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
    test::VideoWriter writer(path, {.codec = "mpeg4", .b_frames = 2});
    for (int i = 0; i < 12; ++i) {
      writer.write(GrayImage(64, 48, static_cast<std::uint8_t>(gray_level(i))).view(), i);
    }
  }
  auto source = open_videos({path}, rig(1), {});
  ASSERT_TRUE(source) << source.error().message;
  const auto frames = frames_of(**source);
  ASSERT_EQ(frames.size(), 12U);
  for (int i = 0; i < 12; ++i) {
    // Whichever the first is: codecs that hold frames back begin later.
    EXPECT_EQ(frames[static_cast<std::size_t>(i)].stamp - frames[0].stamp, milliseconds(40 * i));
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

/// (ms, camera) of every frame.
std::vector<std::pair<int, int>> times_of(const std::vector<VideoFrame>& frames) {
  std::vector<std::pair<int, int>> times;
  for (const VideoFrame& frame : frames) {
    times.emplace_back(static_cast<int>(frame.stamp / milliseconds(1)), frame.camera);
  }
  return times;
}

TEST_F(VideoInput, SynchronizedVideosMeetByStampThenCamera) {
  auto source = open_videos({make_video("a.avi", 3, 25), make_video("b.avi", 5, 50)}, rig(2),
                            {.synchronized = true});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_THAT(times_of(frames_of(**source)),
              ElementsAre(std::pair(0, 0), std::pair(0, 1), std::pair(20, 1), std::pair(40, 0),
                          std::pair(40, 1), std::pair(60, 1), std::pair(80, 0), std::pair(80, 1)));
}

TEST_F(VideoInput, AFrameThatOneVideoLostShiftsNothing) {
  const std::set<int> variants[] = {{0}, {4}, {10}, {3, 11, 12, 13}, {1, 2, 3, 4, 5, 6, 7, 8, 9}};
  for (const std::set<int>& lost : variants) {
    auto source = open_videos({make_video("a.mkv", 45, 25), make_video("b.mkv", 45, 25, lost)},
                              rig(2), {.every = 10, .synchronized = true});
    ASSERT_TRUE(source) << source.error().message;
    std::vector<std::pair<int, int>> expected;
    for (const int frame : {0, 10, 20, 30, 40}) {
      expected.emplace_back(40 * frame, 0);
      if (!lost.contains(frame)) expected.emplace_back(40 * frame, 1);
    }
    EXPECT_EQ(times_of(frames_of(**source)), expected) << *lost.begin();
  }
}

TEST_F(VideoInput, LostFramesShowInTheStamps) {
  auto source = open_videos({make_video("a.mkv", 8, 25, {2, 3})}, rig(1), {});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_THAT(times_of(frames_of(**source)),
              ElementsAre(std::pair(0, 0), std::pair(40, 0), std::pair(160, 0), std::pair(200, 0),
                          std::pair(240, 0), std::pair(280, 0)));
}

TEST_F(VideoInput, APictureOfAnotherSizeOnTheWayEndsWithAClearError) {
  const std::pair<int, int> variants[] = {{80, 48}, {64, 32}, {128, 96}, {32, 24}};
  for (const auto& [width, height] : variants) {
    const fs::path path = folder_.path() / "a.mkv";
    {
      test::VideoWriter writer(path);
      for (int i = 0; i < 6; ++i) {
        writer.write(i < 3 ? GrayImage(64, 48, 100).view() : GrayImage(width, height, 100).view(),
                     i);
      }
    }
    auto source = open_videos({path}, rig(1), {});
    ASSERT_TRUE(source) << source.error().message;
    int frames = 0;
    Expected<std::optional<VideoFrame>> frame = (*source)->next();
    for (; frame && *frame; frame = (*source)->next()) ++frames;
    EXPECT_LE(frames, 3);
    ASSERT_FALSE(frame) << width << "×" << height;
    EXPECT_EQ(frame.error().kind, ErrorKind::bad_data);
    EXPECT_THAT(frame.error().message,
                HasSubstr(fmt::format("frame 3: the picture is {}×{} from here on, 64×48 before",
                                      width, height)));
  }
}

TEST_F(VideoInput, PicturesFarLargerThanTheContainerSaysAreNotDecoded) {
  const auto open_with = [&](int width, int height) {
    const fs::path path = folder_.path() / "a.mkv";
    test::VideoWriter writer(path);
    for (int i = 0; i < 3; ++i) writer.write(GrayImage(64, 48, 100).view(), i);
    writer.write(GrayImage(width, height, 100).view(), 3);
    return path;
  };
  const auto end_of = [](VideoSource& source) {
    Expected<std::optional<VideoFrame>> frame = source.next();
    while (frame && *frame) frame = source.next();
    return frame;
  };
  // 16 mebipixels are decoded, and found to be of another size.
  const auto largest = open_videos({open_with(4096, 4096)}, rig(1), {});
  ASSERT_TRUE(largest);
  EXPECT_FALSE(end_of(**largest));
  const auto larger = open_videos({open_with(4112, 4096)}, rig(1), {});
  ASSERT_TRUE(larger);
  EXPECT_TRUE(end_of(**larger));
  EXPECT_THAT((*larger)->notes(), testing::Contains(HasSubstr("1 frames are damaged")));
}

TEST_F(VideoInput, LumaReachesFromBlackToWhiteInEitherRange) {
  for (const char* codec : {"mjpeg", "mpeg4"}) {  // full range; 16 to 235, which is stated nowhere
    const fs::path path = folder_.path() / "a.avi";
    {
      test::VideoWriter writer(path, {.codec = codec});
      for (int i = 0; i < 3; ++i) writer.write(GrayImage(64, 48, 200).view(), i);
    }
    auto source = open_videos({path}, rig(1), {});
    ASSERT_TRUE(source) << source.error().message;
    for (const VideoFrame& frame : frames_of(**source)) {
      EXPECT_NEAR(frame.image.row(10)[10], 200, 3) << codec;
    }
  }
}

TEST_F(VideoInput, PlayListsAreNoVideos) {
  const fs::path video = make_video("a.avi", 2, 25);
  const std::string lists[] = {"#EXTM3U\n#EXTINF:1,\n" + video.string() + "\n",
                               "ffconcat version 1.0\nfile " + video.string() + "\n"};
  for (const std::string& list : lists) {
    expect_failure(open_videos({folder_.write("list.m3u8", list)}, rig(1), {}), ErrorKind::bad_data,
                   "list.m3u8: not a video");
  }
}

TEST_F(VideoInput, UsageIsChecked) {
  const fs::path a = make_video("a.avi", 2, 25);
  expect_failure(open_videos({a}, rig(1), {.every = 0}), ErrorKind::usage, "--every is 0");
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
  const fs::path whole = folder_.path() / "a.avi";
  {
    test::VideoWriter writer(whole);
    for (int i = 0; i < 8; ++i) writer.write(test_pattern(64, 48).view(), i);
  }
  fs::resize_file(whole, fs::file_size(whole) * 3 / 4);
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
