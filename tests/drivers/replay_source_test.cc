#include "drivers/replay_source.h"

#include <gtest/gtest.h>

#include <thread>

#include "core/capture/pgm.h"
#include "drivers/monotonic_clock.h"
#include "tests/support/room_capture.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;

/// Two cameras, three frames each, 20 ms apart; each image's pixels tell camera and number.
void write_images(const TemporaryFolder& folder) {
  folder.write("rig.yaml", tiny_rig_yaml(2));
  folder.write("markers.toml", tiny_markers_toml());
  for (int camera = 0; camera < 2; ++camera) {
    for (int i = 0; i < 3; ++i) {
      const GrayImage image(64, 48, static_cast<std::uint8_t>(10 * camera + i));
      folder.write("cam" + std::to_string(camera) + "/" +
                       std::to_string(1'000'000'000 + i * 20'000'000) + ".pgm",
                   encode_pgm(image.view()));
    }
  }
}

std::vector<std::unique_ptr<FrameSource>> open_sources(const TemporaryFolder& folder,
                                                       const ReplayOptions& options) {
  auto capture = ReplayCapture::open(folder.path(), options);
  EXPECT_TRUE(capture) << capture.error().message;
  return ReplayCapture::sources(*capture);
}

TEST(ReplaySource, PlaysEveryFrameInOrderWithItsOwnStamp) {
  const TemporaryFolder folder;
  write_images(folder);
  auto sources = open_sources(folder, {});
  ASSERT_EQ(sources.size(), 2U);
  ASSERT_TRUE(sources[1]->start());
  for (int i = 0; i < 3; ++i) {
    auto frame = sources[1]->next(Stamp::max());
    ASSERT_TRUE(frame && *frame);
    EXPECT_EQ((*frame)->stamp(), Stamp(1'000'000'000 + i * 20'000'000));
    EXPECT_EQ((*frame)->info().sequence, static_cast<std::uint64_t>(i));
    EXPECT_EQ((*frame)->info().quality, StampQuality::replayed);
    ASSERT_TRUE((*frame)->has_image());
    EXPECT_EQ((*frame)->image().row(5)[7], 10 + i);
    EXPECT_EQ((*frame)->detections(), nullptr);
  }
  EXPECT_TRUE(sources[1]->ended());
  const auto over = sources[1]->next(Stamp::max());
  ASSERT_TRUE(over);
  EXPECT_FALSE(*over);
}

TEST(ReplaySource, FramesHeldKeepTheirPixelsWhileOthersCome) {
  const TemporaryFolder folder;
  write_images(folder);
  auto sources = open_sources(folder, {});
  ASSERT_TRUE(sources[0]->start());
  auto first = sources[0]->next(Stamp::max());
  auto second = sources[0]->next(Stamp::max());
  ASSERT_TRUE(first && *first && second && *second);
  EXPECT_EQ((*first)->image().row(0)[0], 0);
  EXPECT_EQ((*second)->image().row(0)[0], 1);
  (*first)->release();
  EXPECT_FALSE((*first)->has_image());
  auto third = sources[0]->next(Stamp::max());
  ASSERT_TRUE(third && *third);
  EXPECT_EQ((*third)->image().row(0)[0], 2);
  EXPECT_EQ((*second)->image().row(0)[0], 1) << "a leased buffer was overwritten";
}

TEST(ReplaySource, LoopGoesOnWithRisingStampsAndNumbers) {
  const TemporaryFolder folder;
  write_images(folder);
  ReplayOptions options;
  options.loop = true;
  auto sources = open_sources(folder, options);
  ASSERT_TRUE(sources[0]->start());
  Stamp last{0};
  for (int i = 0; i < 8; ++i) {
    auto frame = sources[0]->next(Stamp::max());
    ASSERT_TRUE(frame && *frame);
    EXPECT_EQ((*frame)->image().row(0)[0], i % 3);
    if (i > 0) {
      EXPECT_EQ((*frame)->stamp() - last, milliseconds(20));
    }
    last = (*frame)->stamp();
  }
  EXPECT_FALSE(sources[0]->ended());
}

TEST(ReplaySource, DamagedImagesArePassedOverAndCounted) {
  const TemporaryFolder folder;
  write_images(folder);
  folder.write("cam0/1020000000.pgm", "P5\n64 48\n255\nshort");
  const GrayImage other_size(32, 48);
  folder.write("cam0/1040000000.pgm", encode_pgm(other_size.view()));
  auto sources = open_sources(folder, {});
  ASSERT_TRUE(sources[0]->start());
  auto first = sources[0]->next(Stamp::max());
  ASSERT_TRUE(first && *first);
  const auto none = sources[0]->next(Stamp::max());
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
  EXPECT_EQ(sources[0]->damaged(), 2U);
}

/// One camera, images that are due the whole time: three within 3 ns, or one alone.
std::vector<std::unique_ptr<FrameSource>> short_rounds(const TemporaryFolder& folder,
                                                       const std::vector<std::int64_t>& stamps,
                                                       const char* content) {
  folder.write("rig.yaml", tiny_rig_yaml(1));
  folder.write("markers.toml", tiny_markers_toml());
  for (const std::int64_t stamp : stamps) {
    folder.write("cam0/" + std::to_string(stamp) + ".pgm",
                 *content != '\0' ? content : encode_pgm(GrayImage(64, 48, 7).view()));
  }
  ReplayOptions options;
  options.realtime = true;
  options.loop = true;
  return open_sources(folder, options);
}

TEST(ReplaySource, ARoundThatIsShorterThanATurnNeitherHoldsUpNextNorStop) {
  // Two stamps do not show what they are; 1 ns apart they make a round of 2 ns.
  for (const auto& stamps :
       {std::vector<std::int64_t>{1, 2}, {1'000'000'000, 1'000'000'001}, {5}}) {
    const TemporaryFolder folder;
    auto sources = short_rounds(folder, stamps, "");
    ASSERT_TRUE(sources[0]->start());
    Stamp last = Stamp::min();
    std::uint64_t number = 0;
    for (int i = 0; i < 5; ++i) {
      const auto frame = sources[0]->next(Stamp::max());
      ASSERT_TRUE(frame && *frame);
      EXPECT_GT((*frame)->stamp(), last);
      EXPECT_LE((*frame)->stamp(), monotonic_now());
      EXPECT_GE((*frame)->info().sequence, number);
      last = (*frame)->stamp();
      number = (*frame)->info().sequence + 1;
    }
    sources[0]->stop();
    const auto stopped = sources[0]->next(Stamp::max());
    ASSERT_TRUE(stopped);
    EXPECT_FALSE(*stopped);
  }
}

TEST(ReplaySource, ARoundWithoutOneUsableImageIsAnErrorNotALoop) {
  for (const bool realtime : {true, false}) {
    for (const char* content : {"P5 1 1 255\nx", "GIF89a", "P5\n64 48\n255\nshort"}) {
      const TemporaryFolder folder;
      auto sources = short_rounds(folder, {0, 1'000'000, 2'000'000}, content);
      if (!realtime) {
        ReplayOptions options;
        options.loop = true;
        sources = open_sources(folder, options);
      }
      ASSERT_TRUE(sources[0]->start());
      auto frame = sources[0]->next(Stamp::max());
      ASSERT_FALSE(frame) << content;
      EXPECT_NE(frame.error().message.find("no image of 3 can be used; the first: "),
                std::string::npos);
    }
  }
}

TEST(ReplaySource, WhoComesLateFindsTheNewest) {
  const TemporaryFolder folder;
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 50; ++i) stamps.push_back(i * 1'000'000);
  auto sources = short_rounds(folder, stamps, "");
  ASSERT_TRUE(sources[0]->start());
  for (int i = 0; i < 20; ++i) {
    const Stamp before = monotonic_now();
    const auto frame = sources[0]->next(Stamp::max());
    ASSERT_TRUE(frame && *frame);
    EXPECT_GE((*frame)->stamp(), before - milliseconds(1));
  }
}

TEST(ReplayCapture, StampsAtTheEndsOfTheirRangeNeitherOverflowNorHang) {
  const std::int64_t last = kLargestStamp.count();
  const std::vector<std::int64_t> variants[] = {{last},
                                                {-last},
                                                {last - 1'000'000, last},
                                                {0, last},
                                                {-last, -last + 1'000'000, -last + 2'000'000}};
  for (const auto& stamps : variants) {
    for (const bool realtime : {true, false}) {
      const TemporaryFolder folder;
      auto sources = short_rounds(folder, stamps, "");
      if (!realtime) {
        ReplayOptions options;
        options.loop = true;
        sources = open_sources(folder, options);
      }
      ASSERT_TRUE(sources[0]->start());
      for (int i = 0; i < 3 && !sources[0]->ended(); ++i) {
        EXPECT_TRUE(sources[0]->next(monotonic_now() + milliseconds(20)));
      }
    }
  }
  const TemporaryFolder folder;
  folder.write("rig.yaml", tiny_rig_yaml(1));
  folder.write("markers.toml", tiny_markers_toml());
  for (const std::int64_t stamp : {-last, last}) {
    folder.write("cam0/" + std::to_string(stamp) + ".pgm", "");
  }
  EXPECT_EQ(ReplayCapture::open(folder.path(), {}).error().cause, Cause::stamps);
}

TEST(ReplayCapture, ImagesThatCanNotBeUsedAreCountedWithTheFirstReason) {
  const TemporaryFolder folder;
  write_images(folder);
  folder.write("cam0/1000000000.pgm", "");
  folder.write("cam1/1020000000.pgm", encode_pgm(GrayImage(32, 48).view()));
  const auto capture = ReplayCapture::open(folder.path(), {});
  ASSERT_TRUE(capture);
  for (auto& source : ReplayCapture::sources(*capture)) {
    ASSERT_TRUE(source->start());
    while (!source->ended()) ASSERT_TRUE(source->next(Stamp::max()));
  }
  EXPECT_EQ((*capture)->unusable().images, 2U);
  EXPECT_NE((*capture)->unusable().first_reason.find("1000000000.pgm: empty file"),
            std::string::npos);
}

TEST(ReplaySource, DetectionsAloneAreFramesWithoutImage) {
  const auto room = test::make_room({.markers = 12, .frame_sets = 4, .cameras = 2});
  const TemporaryFolder folder;
  test::write_room_capture(folder, room);
  auto sources = open_sources(folder, {});
  ASSERT_TRUE(sources[0]->start());
  auto frame = sources[0]->next(Stamp::max());
  ASSERT_TRUE(frame && *frame);
  EXPECT_FALSE((*frame)->has_image());
  ASSERT_NE((*frame)->detections(), nullptr);
  EXPECT_EQ((*frame)->detections()->detections.size(), room.images[0].detections.size());
}

TEST(ReplaySource, RealTimeMovesStampsToTheMonotonicClockAndWaits) {
  const TemporaryFolder folder;
  write_images(folder);
  ReplayOptions options;
  options.realtime = true;
  auto capture = ReplayCapture::open(folder.path(), options);
  ASSERT_TRUE(capture);
  auto sources = ReplayCapture::sources(*capture);
  const Stamp before = monotonic_now();
  ASSERT_TRUE(sources[0]->start());
  auto frame = sources[0]->next(before + std::chrono::seconds(10));
  ASSERT_TRUE(frame && *frame);
  EXPECT_GE((*frame)->stamp(), before);
  EXPECT_LE((*frame)->stamp(), monotonic_now());
  EXPECT_EQ((*frame)->stamp() - (*capture)->shift(), Stamp(1'000'000'000));
  const auto early = sources[0]->next(monotonic_now());
  ASSERT_TRUE(early);
  // Unless the machine slept for 20 ms, the second frame is not due yet.
  if (*early) {
    EXPECT_GE(monotonic_now() - (*frame)->stamp(), milliseconds(20));
  }
}

TEST(ReplaySource, StopEndsAWaitingNext) {
  const TemporaryFolder folder;
  write_images(folder);
  ReplayOptions options;
  options.realtime = true;
  options.loop = true;
  auto sources = open_sources(folder, options);
  ASSERT_TRUE(sources[0]->start());
  std::thread stopper([&] { sources[0]->stop(); });
  // Without the stop this would go on for ever.
  for (;;) {
    const auto frame = sources[0]->next(Stamp::max());
    ASSERT_TRUE(frame);
    if (!*frame) break;
  }
  stopper.join();
}

TEST(ReplayCapture, RefusesWhatCanNotBePlayed) {
  const TemporaryFolder folder;
  EXPECT_EQ(ReplayCapture::open(folder.path() / "absent", {}).error().kind, ErrorKind::no_input);
  write_images(folder);
  ReplayOptions nothing;
  nothing.images = false;
  EXPECT_EQ(ReplayCapture::open(folder.path(), nothing).error().kind, ErrorKind::bad_data);
}

}  // namespace
}  // namespace waymark
