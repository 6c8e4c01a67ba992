#include "drivers/v4l2/v4l2_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/capture/jpeg.h"
#include "drivers/frame_maker.h"
#include "tests/drivers/v4l2/fake_video_system.h"

namespace waymark {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::FakeControl;
using test::FakeDevice;
using test::FakeFrame;
using testing::HasSubstr;

constexpr int kWidth = 64;
constexpr int kHeight = 48;

class V4l2SourceTest : public testing::Test {
 protected:
  V4l2SourceTest() {
    options_.name = "cam0";
    options_.device.serial = "4711";
    options_.request = {kWidth, kHeight, nullptr, 30};
  }

  [[nodiscard]] FakeDevice& camera() { return system_->cameras.front(); }
  [[nodiscard]] FrameSource& source() {
    if (source_ == nullptr) source_ = v4l2_source(system_, options_);
    return *source_;
  }
  [[nodiscard]] Error start_error() {
    const Status started = source().start();
    return started ? Error{ErrorKind::internal, "started"} : started.error();
  }
  [[nodiscard]] Expected<std::optional<Frame>> next() {
    return source().next(system_->time + milliseconds(100));
  }

  /// A grey frame of one value.
  [[nodiscard]] FakeFrame grey(std::uint32_t sequence, std::uint8_t value = 77) const {
    return {std::vector<std::uint8_t>(kWidth * kHeight, value), sequence,
            system_->time - milliseconds(10)};
  }
  void deliver(FakeFrame frame) { camera().frames.push_back(std::move(frame)); }
  /// Delivers and expects a frame of it.
  [[nodiscard]] Frame taken(FakeFrame frame) {
    deliver(std::move(frame));
    auto got = next();
    EXPECT_TRUE(got) << got.error().message;
    EXPECT_TRUE(got && got->has_value());
    return got && *got ? std::move(**got) : Frame();
  }

  std::shared_ptr<test::FakeVideoSystem> system_ = std::make_shared<test::FakeVideoSystem>();
  CameraOptions options_;
  std::unique_ptr<FrameSource> source_;
};

TEST_F(V4l2SourceTest, GreyFramesLieWhereTheDriverPutThem) {
  camera().stride_bytes = 80;
  ASSERT_TRUE(source().start());
  FakeFrame frame = grey(5);
  frame.bytes.assign(80 * kHeight, 0);
  frame.bytes[80 + 3] = 200;
  const Frame got = taken(frame);
  EXPECT_EQ(got.image().data, camera().memory[0]->data());
  EXPECT_EQ(got.image().stride_bytes, 80U);
  EXPECT_EQ(got.image().row(1)[3], 200);
  EXPECT_EQ(got.info().sequence, 5U);
  EXPECT_EQ(got.info().arrival, system_->time);
}

TEST_F(V4l2SourceTest, TwoBuffersAlwaysStayWithTheDriver) {
  for (const std::size_t buffers : {3U, 4U, 6U}) {
    camera().most_buffers = buffers;
    ASSERT_TRUE(source().start());
    const std::uint64_t lost_before = source().lost();
    std::vector<Frame> held;
    for (std::uint32_t i = 0; i < buffers; ++i) {
      deliver(grey(i));
      auto frame = next();
      ASSERT_TRUE(frame) << frame.error().message;
      if (*frame) held.push_back(std::move(**frame));
      EXPECT_GE(camera().queued.size(), 2U);
    }
    EXPECT_EQ(held.size(), buffers - 2);
    EXPECT_EQ(source().lost() - lost_before, 2U);
    held.pop_back();
    EXPECT_TRUE(taken(grey(99)).has_image());
  }
}

TEST_F(V4l2SourceTest, ABufferForWhichTheDriverWaitsGoesBackWhileNextWaits) {
  camera().most_buffers = 3;
  ASSERT_TRUE(source().start());
  std::optional<Frame> held = taken(grey(0));
  std::vector<std::size_t> queued;
  camera().during_wait = [&] {
    queued.push_back(camera().queued.size());
    held.reset();  // in truth from another thread
  };
  const auto none = next();
  ASSERT_TRUE(none);
  EXPECT_FALSE(none->has_value());
  EXPECT_THAT(queued, testing::ElementsAre(2, 3));
}

TEST_F(V4l2SourceTest, FramesOutliveTheDevice) {
  ASSERT_TRUE(source().start());
  const Frame before = taken(grey(0, 11));
  camera().gone = true;
  const auto lost = next();
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().kind, ErrorKind::unavailable);
  EXPECT_THAT(lost.error().message, HasSubstr("/dev/video0"));
  EXPECT_EQ(camera().opened, 0);
  camera().gone = false;
  camera().frames.clear();
  ASSERT_TRUE(source().start());
  const Frame after = taken(grey(0, 22));
  EXPECT_EQ(before.image().row(kHeight - 1)[kWidth - 1], 11);
  EXPECT_EQ(after.image().row(kHeight - 1)[kWidth - 1], 22);
}

TEST_F(V4l2SourceTest, BuffersGoBackToTheDriverWhenAStreamEndsAlsoWhileFramesAreLent) {
  ASSERT_TRUE(source().start());
  const Frame lent = taken(grey(0, 11));
  ASSERT_FALSE(camera().memory.empty());
  source().close();
  EXPECT_TRUE(camera().memory.empty());
  EXPECT_EQ(lent.image().row(kHeight - 1)[kWidth - 1], 11);
}

TEST_F(V4l2SourceTest, IsFoundAgainByItsSerialNumberUnderAnotherNodeAndSetAnew) {
  camera().controls[V4L2_CID_EXPOSURE_AUTO] = {0, 3, 1, 3};
  camera().controls[V4L2_CID_EXPOSURE_ABSOLUTE] = {1, 5000, 1, 100};
  options_.controls.exposure_us = 2000;
  ASSERT_TRUE(source().start());
  camera().gone = true;
  EXPECT_FALSE(next());
  EXPECT_EQ(start_error().kind, ErrorKind::unavailable);
  // Another camera takes the node; ours comes back under another one, as it was when made.
  FakeDevice ours = camera();
  ours.identity.node = "/dev/video2";
  ours.gone = false;
  ours.controls[V4L2_CID_EXPOSURE_AUTO].value = 3;
  ours.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 100;
  camera() = FakeDevice();
  camera().identity.serial = "0815";
  system_->cameras.push_back(ours);
  ASSERT_TRUE(source().start());
  EXPECT_EQ(system_->cameras[1].controls[V4L2_CID_EXPOSURE_ABSOLUTE].value, 20);
  EXPECT_EQ(system_->cameras[1].controls[V4L2_CID_EXPOSURE_AUTO].value, V4L2_EXPOSURE_MANUAL);
  EXPECT_FALSE(camera().streams);
  EXPECT_TRUE(system_->cameras[1].streams);
}

TEST_F(V4l2SourceTest, ShortAndFlaggedFramesAreDroppedAndCounted) {
  ASSERT_TRUE(source().start());
  FakeFrame cut = grey(0);
  cut.bytes.pop_back();
  FakeFrame flagged = grey(1);
  flagged.flags |= V4L2_BUF_FLAG_ERROR;
  deliver(cut);
  deliver(flagged);
  EXPECT_EQ(taken(grey(2)).info().sequence, 2U);
  EXPECT_EQ(source().damaged(), 2U);
  EXPECT_EQ(source().lost(), 0U);
  EXPECT_EQ(camera().queued.size(), 5U);
}

TEST_F(V4l2SourceTest, GapsInTheDevicesCountAreLostFrames) {
  ASSERT_TRUE(source().start());
  for (const std::uint32_t sequence : {0xFFFFFFFEU, 0xFFFFFFFFU, 0U, 3U}) {
    EXPECT_TRUE(taken(grey(sequence)).has_image());
  }
  EXPECT_EQ(source().lost(), 2U);
  // A driver that counts anew, or not at all, lost nothing.
  EXPECT_EQ(taken(grey(0)).info().sequence, 0xFFFFFFFEULL + 6);
  EXPECT_EQ(taken(grey(0)).info().sequence, 0xFFFFFFFEULL + 7);
  EXPECT_EQ(source().lost(), 2U);
}

TEST_F(V4l2SourceTest, ADeviceWithoutWholeFramesIsToBeStartedAgain) {
  ASSERT_TRUE(source().start());
  const Stamp patience = milliseconds(2000) + milliseconds(5000) / 30;
  system_->time += patience - milliseconds(1);
  EXPECT_TRUE(next());
  FakeFrame cut = grey(0);
  cut.bytes.clear();
  deliver(cut);
  system_->time += milliseconds(2);
  const auto stalled = next();
  ASSERT_FALSE(stalled);
  EXPECT_EQ(stalled.error().kind, ErrorKind::io);
  EXPECT_THAT(stalled.error().message, HasSubstr("no whole frame for 2.2 s"));
  EXPECT_FALSE(camera().streams);
  EXPECT_TRUE(source().start());
  EXPECT_TRUE(taken(grey(0)).has_image());
}

TEST_F(V4l2SourceTest, FramesThatNobodyGivesBackAreNoStall) {
  camera().most_buffers = 3;
  ASSERT_TRUE(source().start());
  const Frame held = taken(grey(0));
  for (std::uint32_t i = 1; i < 5; ++i) {
    system_->time += seconds(1);
    deliver(grey(i));
    const auto none = next();
    ASSERT_TRUE(none) << none.error().message;
    EXPECT_FALSE(none->has_value());
  }
  EXPECT_EQ(source().lost(), 4U);
}

TEST_F(V4l2SourceTest, AnErrorThatOnlyPollTellsEndsTheStream) {
  ASSERT_TRUE(source().start());
  camera().error_in_poll = true;
  const auto failed = next();
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().kind, ErrorKind::io);
}

TEST_F(V4l2SourceTest, StopEndsNextAndCloseGivesTheDeviceBack) {
  ASSERT_TRUE(source().start());
  deliver(grey(0));
  source().stop();
  EXPECT_TRUE(next());  // what is there already may come
  const auto none = next();
  ASSERT_TRUE(none);
  EXPECT_FALSE(none->has_value());
  source().close();
  EXPECT_EQ(camera().opened, 0);
  EXPECT_FALSE(camera().streams);
}

TEST_F(V4l2SourceTest, StampsAreTheMiddleOfTheExposure) {
  camera().controls[V4L2_CID_EXPOSURE_ABSOLUTE] = {1, 5000, 1, 100};
  options_.controls.exposure_us = 4000;
  options_.readout = microseconds(10'000);
  ASSERT_TRUE(source().start());
  const FakeFrame frame = grey(0);
  const Frame got = taken(frame);
  EXPECT_EQ(got.stamp(), frame.stamp + microseconds(7000));
  EXPECT_EQ(got.info().quality, StampQuality::exact);
  EXPECT_EQ(got.info().exposure, microseconds(4000));
  EXPECT_THAT(source().describe(), HasSubstr("exposure 4000 µs"));
  EXPECT_THAT(source().describe(), HasSubstr("start of exposure"));
}

TEST_F(V4l2SourceTest, AutomaticExposureThatStaysMakesStampsApproximate) {
  camera().controls[V4L2_CID_EXPOSURE_AUTO] = {0, 3, 1, 3, true};
  camera().controls[V4L2_CID_EXPOSURE_ABSOLUTE] = {1, 5000, 1, 100};
  options_.controls.exposure_us = 2000;
  ASSERT_TRUE(source().start());
  const FakeFrame frame = grey(0);
  const Frame got = taken(frame);
  EXPECT_EQ(got.stamp(), frame.stamp);
  EXPECT_EQ(got.info().quality, StampQuality::approximate);
  EXPECT_THAT(source().describe(), HasSubstr("automatic exposure can't be switched off"));
}

TEST_F(V4l2SourceTest, YuyvIsConvertedAndItsBufferGivenBackAtOnce) {
  camera().formats = {{V4L2_PIX_FMT_YUYV, {{kWidth, kHeight}}}};
  ASSERT_TRUE(source().start());
  FakeFrame frame = grey(0);
  frame.bytes.assign(2 * kWidth * kHeight, 128);
  for (std::size_t i = 0; i < frame.bytes.size(); i += 2) frame.bytes[i] = 33;
  std::vector<Frame> held;
  for (int i = 0; i < 4; ++i) held.push_back(taken(frame));
  EXPECT_EQ(held[3].image().row(kHeight - 1)[kWidth - 1], 33);
  EXPECT_EQ(camera().queued.size(), FrameMaker::kBuffers);
  deliver(frame);
  EXPECT_FALSE(next()->has_value());
  EXPECT_EQ(source().lost(), 1U);
}

TEST_F(V4l2SourceTest, JpegsAreDecodedAndTruncatedOnesCounted) {
  camera().formats = {{V4L2_PIX_FMT_MJPEG, {{kWidth, kHeight}}}};
  ASSERT_TRUE(source().start());
  const auto encode = [](int width, int height) {
    const std::string jpeg = *encode_jpeg(GrayImage(width, height, 90).view(), 95);
    return FakeFrame{{jpeg.begin(), jpeg.end()}, 0, seconds(1000)};
  };
  FakeFrame cut = encode(kWidth, kHeight);
  cut.bytes.resize(cut.bytes.size() / 2);
  deliver(cut);
  deliver(encode(kWidth, kHeight - 1));
  deliver({{}, 0, seconds(1000)});
  EXPECT_EQ(taken(encode(kWidth, kHeight)).image().row(20)[30], 90);
  EXPECT_EQ(source().damaged(), 3U);
}

TEST_F(V4l2SourceTest, MultiPlanarDevicesGiveTheirFirstPlane) {
  camera().multiplanar = true;
  camera().formats = {{V4L2_PIX_FMT_NV12M, {{kWidth, kHeight}}}};
  ASSERT_TRUE(source().start());
  EXPECT_EQ(taken(grey(0, 55)).image().row(kHeight - 1)[kWidth - 1], 55);
}

TEST_F(V4l2SourceTest, AnotherSerialNumberThanTheRigsIsRefused) {
  options_.device = {"", "", "usb-1"};
  options_.serial = "0815";
  const Error error = start_error();
  EXPECT_EQ(error.kind, ErrorKind::config);
  EXPECT_THAT(error.message, HasSubstr("\"4711\""));
  EXPECT_THAT(error.message, HasSubstr("\"0815\""));
}

TEST_F(V4l2SourceTest, ABusyDeviceNamesItsHolder) {
  camera().holders = {{1234, "cheese"}, {::getpid(), "locd"}, {1235, "guvcview"}};
  Error error = start_error();
  EXPECT_EQ(error.kind, ErrorKind::unavailable);
  EXPECT_THAT(error.message, HasSubstr("cheese (pid 1234), guvcview (pid 1235) uses it"));
  EXPECT_THAT(source().inspect()->holders, testing::ElementsAre(1234, ::getpid(), 1235));
  camera().holders = {{::getpid(), "locd"}};
  EXPECT_THAT(start_error().message, HasSubstr("two [[camera]] blocks"));
  camera().holders.clear();
  camera().failures[VIDIOC_REQBUFS] = EBUSY;
  EXPECT_THAT(start_error().message, HasSubstr("fuser -v /dev/video0"));
}

TEST_F(V4l2SourceTest, ErrorsNameWhatHelps) {
  camera().failures[VIDIOC_STREAMON] = ENOSPC;
  EXPECT_THAT(start_error().message, HasSubstr("USB bandwidth"));
  camera().failures[VIDIOC_STREAMON] = EIO;
  EXPECT_EQ(start_error().kind, ErrorKind::io);
  camera().failures.clear();
  camera().most_buffers = 2;
  EXPECT_THAT(start_error().message, HasSubstr("only 2 buffers"));
  EXPECT_EQ(camera().opened, 0);
  system_->cannot_open = Error{ErrorKind::permission, "/dev/video0: group video"};
  EXPECT_EQ(start_error().kind, ErrorKind::permission);
}

TEST_F(V4l2SourceTest, AStartOfManySlowCallsTurnsOneThatIsStuckDoesNot) {
  camera().during_request = [&, calls = 0]() mutable {
    system_->time += milliseconds(500);
    if (++calls > 1) {
      EXPECT_EQ(system_->time - source().last_turn(), milliseconds(500));
    }
  };
  const Stamp before = system_->time;
  ASSERT_TRUE(source().start());
  EXPECT_GT(system_->time - before, seconds(5));
  camera().during_request = [&] {
    const Stamp turned = source().last_turn();
    system_->time += seconds(3600);
    EXPECT_EQ(source().last_turn(), turned) << "stuck in a call";
    camera().during_request = nullptr;
  };
  EXPECT_TRUE(source().start());
}

TEST_F(V4l2SourceTest, NobodyElseSetsAnythingWhereTheDriverKnowsPriorities) {
  ASSERT_TRUE(source().start());
  EXPECT_EQ(camera().priority, V4L2_PRIORITY_RECORD);
  camera().failures[VIDIOC_S_PRIORITY] = ENOTTY;
  EXPECT_TRUE(source().start()) << "the watch does without";
}

TEST_F(V4l2SourceTest, WhatAnotherProgramChangesIsToldSetAgainAndMakesStampsApproximate) {
  camera().controls[V4L2_CID_EXPOSURE_AUTO] = {0, 3, 1, 3};
  FakeControl& exposure = camera().controls[V4L2_CID_EXPOSURE_ABSOLUTE] = {1, 5000, 1, 100};
  options_.controls.exposure_us = 2000;
  ASSERT_TRUE(source().start());
  EXPECT_EQ(taken(grey(0)).info().quality, StampQuality::exact);
  exposure.value = 300;
  system_->time += seconds(1);
  EXPECT_EQ(taken(grey(1)).info().quality, StampQuality::approximate);
  EXPECT_THAT(std::string(source().changed_settings()),
              HasSubstr("exposure was set from 20 to 300 by another program"));
  EXPECT_EQ(exposure.value, 20);
  system_->time += seconds(1);
  EXPECT_EQ(taken(grey(2)).info().quality, StampQuality::exact);
  EXPECT_EQ(source().changed_settings(), "");
}

TEST_F(V4l2SourceTest, WithoutStartThereAreNoFrames) {
  const auto frame = next();
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, ErrorKind::unavailable);
}

}  // namespace
}  // namespace waymark
