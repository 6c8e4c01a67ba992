#include "tests/vm/uvc_camera/video_stream.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace waymark::uvc {
namespace {

using std::chrono::milliseconds;

constexpr std::uint32_t kRoom = 1'000'000;

/// `count` images of 100,000 pixels, each filled with its number; 10 a second.
FrameFeed numbered_frames(int count) {
  FrameFeed feed;
  feed.format.width_px = 400;
  feed.format.height_px = 250;
  feed.format.fps = 10;
  feed.format.max_frame_bytes = 100'000;
  for (int i = 0; i < count; ++i) feed.images.emplace_back(100'000, static_cast<std::uint8_t>(i));
  return feed;
}

struct Received {
  Bytes image;
  std::uint8_t parity = 0;
};

/// One whole frame, as a host puts it together.
Received receive(VideoStream& stream, Instant now, std::uint32_t room = kRoom) {
  Received received;
  while (const auto payload = stream.next_payload(now, room)) {
    EXPECT_LE(payload->size(), std::min(room, kMaxPayloadBytes));
    EXPECT_EQ((*payload)[0], 2);
    received.parity = (*payload)[1] & 1U;
    received.image.insert(received.image.end(), payload->begin() + 2, payload->end());
    if (((*payload)[1] & 2U) != 0) return received;
  }
  ADD_FAILURE() << "a frame without an end";
  return received;
}

TEST(VideoStream, AFrameComesWholeWhenItsTimeHasCome) {
  VideoStream stream(numbered_frames(4));
  EXPECT_EQ(stream.next_payload(milliseconds(1000), kRoom), std::nullopt);
  stream.start(milliseconds(1030));
  EXPECT_EQ(stream.due(), milliseconds(1100));
  EXPECT_EQ(stream.next_payload(milliseconds(1099), kRoom), std::nullopt);
  EXPECT_EQ(receive(stream, milliseconds(1100)).image, numbered_frames(4).frame(11));
  EXPECT_EQ(stream.next_payload(milliseconds(1101), kRoom), std::nullopt);
  EXPECT_EQ(receive(stream, milliseconds(1200)).image, numbered_frames(4).frame(12));
}

TEST(VideoStream, CamerasThatStartAtDifferentTimesShowTheSameInstant) {
  VideoStream early(numbered_frames(7));
  VideoStream late(numbered_frames(7));
  early.start(milliseconds(1030));
  late.start(milliseconds(5570));
  EXPECT_EQ(receive(early, milliseconds(5600)).image, receive(late, milliseconds(5620)).image);
}

TEST(VideoStream, AHostThatReadsTooSlowlyLosesWholeFrames) {
  VideoStream stream(numbered_frames(4));
  stream.start(milliseconds(1030));
  EXPECT_EQ(receive(stream, milliseconds(1420)).image, numbered_frames(4).frame(14));
  EXPECT_EQ(stream.counts().skipped, 3);
  EXPECT_EQ(stream.counts().sent, 1);
}

TEST(VideoStream, AFrameThatCouldBeginMuchTooLateOnlyIsLeftOut) {
  VideoStream stream(numbered_frames(4));
  stream.start(milliseconds(1030));
  EXPECT_EQ(stream.next_payload(milliseconds(1421), kRoom), std::nullopt);
  EXPECT_EQ(stream.counts().skipped, 4);
  EXPECT_EQ(stream.due(), milliseconds(1500));
  EXPECT_EQ(receive(stream, milliseconds(1500)).image, numbered_frames(4).frame(15));
}

TEST(VideoStream, TheFrameBitChangesWithEveryFrame) {
  VideoStream stream(numbered_frames(2));
  stream.start(milliseconds(0));
  const auto first = receive(stream, milliseconds(100)).parity;
  EXPECT_NE(receive(stream, milliseconds(200)).parity, first);
}

TEST(VideoStream, SmallTransfersMakeTheSameFrame) {
  VideoStream stream(numbered_frames(2));
  stream.start(milliseconds(0));
  EXPECT_EQ(receive(stream, milliseconds(100), 512).image, numbered_frames(2).frame(1));
}

TEST(VideoStream, ShortFramesEndHalfWayAndThenAllIsWell) {
  VideoStream stream(numbered_frames(2));
  stream.shorten(1);
  stream.start(milliseconds(0));
  EXPECT_EQ(receive(stream, milliseconds(100)).image.size(), 50'000U);
  EXPECT_EQ(receive(stream, milliseconds(200)).image.size(), 100'000U);
}

TEST(VideoStream, AStalledCameraSendsNothing) {
  VideoStream stream(numbered_frames(2));
  stream.start(milliseconds(0));
  stream.stall(true);
  EXPECT_EQ(stream.due(), std::nullopt);
  EXPECT_EQ(stream.next_payload(milliseconds(500), kRoom), std::nullopt);
  stream.stall(false);
  EXPECT_EQ(receive(stream, milliseconds(500)).image, numbered_frames(2).frame(5));
}

TEST(VideoStream, AFrozenCameraRepeatsItsImage) {
  VideoStream stream(numbered_frames(4));
  stream.start(milliseconds(0));
  EXPECT_EQ(receive(stream, milliseconds(100)).image, numbered_frames(4).frame(1));
  stream.freeze(true);
  EXPECT_EQ(receive(stream, milliseconds(200)).image, numbered_frames(4).frame(1));
  stream.freeze(false);
  EXPECT_EQ(receive(stream, milliseconds(300)).image, numbered_frames(4).frame(3));
}

TEST(VideoStream, APaintedCameraShowsAGreyThatIsNotFrozen) {
  VideoStream stream(numbered_frames(4));
  stream.paint(255);
  stream.start(milliseconds(0));
  const Bytes first = receive(stream, milliseconds(100)).image;
  const Bytes second = receive(stream, milliseconds(200)).image;
  EXPECT_EQ(first, numbered_frames(4).painted_frame(255, 1));
  EXPECT_EQ(second, numbered_frames(4).painted_frame(255, 2));
  EXPECT_NE(first, second);
  stream.paint(std::nullopt);
  EXPECT_EQ(receive(stream, milliseconds(300)).image, numbered_frames(4).frame(3));
}

}  // namespace
}  // namespace waymark::uvc
