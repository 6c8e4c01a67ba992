#include "locd/frames/rig_capture.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/fake_camera.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::FakeCamera;

class RigCaptureTest : public testing::Test {
 protected:
  RigCaptureTest() {
    auto camera = std::make_unique<FakeCamera>("cam0", 8, 8);
    camera_ = camera.get();
    std::vector<std::unique_ptr<FrameSource>> sources;
    sources.push_back(std::move(camera));
    capture_ = std::make_unique<RigCapture>(std::move(sources), SyncOptions{});
  }
  template <typename Holds>
  [[nodiscard]] static bool comes(const Holds& holds, Stamp patience = seconds(20)) {
    for (const Stamp deadline = monotonic_now() + patience; !holds();) {
      if (monotonic_now() > deadline) return false;
      std::this_thread::yield();
    }
    return true;
  }

  FakeCamera* camera_ = nullptr;
  std::unique_ptr<RigCapture> capture_;
};

TEST_F(RigCaptureTest, ADeviceThatComesEndsTheBackOff) {
  camera_->fail_with("absent");
  capture_->start();
  // Pauses of 0.1 to 1.6 s are over: the next one is 3.2 s, or, should this thread come late, 5 s.
  ASSERT_TRUE(comes([&] { return camera_->starts() >= 6; }));
  const Stamp device_came = monotonic_now();
  capture_->retry();
  const std::size_t attempt = camera_->starts();
  ASSERT_TRUE(comes([&] { return camera_->starts() > attempt + 1; }));
  const std::vector<Stamp> started = camera_->started();
  EXPECT_LT(started[attempt] - device_came, seconds(2));
  EXPECT_LT(started[attempt + 1] - started[attempt], seconds(2)) << "the back-off begins anew";
  camera_->fail_with("");
  capture_->retry();
  camera_->give(monotonic_now());
  EXPECT_TRUE(comes([&] { return capture_->state(0).frames == 1; }));
  EXPECT_EQ(capture_->state(0).description, "64×48, fake");
}

TEST_F(RigCaptureTest, WaitingForADeviceIsATurn) {
  camera_->fail_with("absent");
  capture_->start();
  ASSERT_TRUE(comes([&] { return camera_->starts() >= 6; }));  // a pause of 3.2 s begins
  const std::size_t attempts = camera_->starts();
  std::set<Stamp> turns;
  ASSERT_TRUE(comes([&] {
    turns.insert(capture_->state(0).last_turn);
    return camera_->starts() > attempts;
  }));
  EXPECT_GE(turns.size(), 5U);  // of sixteen; the attempts themselves make three
}

TEST_F(RigCaptureTest, AStartOfManyCallsTurnsOneThatIsStuckDoesNot) {
  camera_->get_stuck();
  capture_->start();
  ASSERT_TRUE(comes([&] { return capture_->state(0).last_turn > Stamp{0}; }));
  const Stamp before = capture_->state(0).last_turn;
  EXPECT_EQ(capture_->state(0).last_turn, before) << "stuck in start";
  camera_->turn(before + milliseconds(5));
  EXPECT_EQ(capture_->state(0).last_turn, before + milliseconds(5));
  camera_->release();
}

TEST_F(RigCaptureTest, WhatEndedACameraIsSaidUntilItsNextFrame) {
  capture_->start();
  camera_->give(monotonic_now());
  ASSERT_TRUE(comes([&] { return capture_->state(0).frames == 1; }));
  camera_->fail_next_with("no whole frame for 2.2 s", ErrorKind::io);
  ASSERT_TRUE(comes([&] { return !capture_->state(0).error.empty(); }));
  camera_->fail_with("");
  ASSERT_TRUE(comes([&] { return capture_->state(0).starts >= 2; }));
  EXPECT_EQ(capture_->state(0).error, "no whole frame for 2.2 s") << "it runs, but gives no frame";
  camera_->give(monotonic_now());
  ASSERT_TRUE(comes([&] { return capture_->state(0).frames == 2; }));
  EXPECT_EQ(capture_->state(0).error, "");
}

TEST_F(RigCaptureTest, ArrivalIsWhenTheDriverGaveTheFrameNotWhenItWasConverted) {
  camera_->take_long(milliseconds(400));
  capture_->start();
  const Stamp an_hour_off = monotonic_now() + std::chrono::hours(1);
  std::optional<FrameSetLease> set;
  for (int i = 0; i < 50 && !set; ++i) {  // until its stamps are not believed
    camera_->give(an_hour_off + i * milliseconds(1));
    set = capture_->wait(monotonic_now() + milliseconds(20));
  }
  ASSERT_TRUE(set);
  EXPECT_EQ(set->frames[0].info().quality, StampQuality::arrival);
  EXPECT_EQ(set->frames[0].stamp(), set->frames[0].info().arrival);
}

TEST_F(RigCaptureTest, TheDeviceIsClosedByItsOwnThreadWhenItEnds) {
  capture_->start();
  camera_->give(monotonic_now());
  ASSERT_TRUE(comes([&] { return capture_->state(0).frames == 1; }));
  EXPECT_FALSE(camera_->closed());
  capture_->stop();
  EXPECT_TRUE(camera_->closed());
}

TEST_F(RigCaptureTest, WhatOnlyAnotherConfigurationMendsIsTold) {
  camera_->fail_with("absent");
  capture_->start();
  ASSERT_TRUE(comes([&] { return !capture_->state(0).error.empty(); }));
  EXPECT_FALSE(capture_->state(0).misconfigured);
  // As at boot, before udev has set the group: it is tried again, not ended with 78.
  camera_->fail_with("group video", ErrorKind::permission);
  ASSERT_TRUE(comes([&] { return capture_->state(0).error == "group video"; }));
  EXPECT_FALSE(capture_->state(0).misconfigured);
  camera_->fail_with("another serial number", ErrorKind::config);
  EXPECT_TRUE(comes([&] { return capture_->state(0).misconfigured; }));
}

TEST_F(RigCaptureTest, WhatOnlyAnotherConfigurationMendsMayShowInTheFirstFrame) {
  capture_->start();
  ASSERT_TRUE(comes([&] { return capture_->state(0).starts == 1; }));
  EXPECT_FALSE(capture_->state(0).misconfigured);
  camera_->fail_next_with("a crop", ErrorKind::config);
  EXPECT_TRUE(comes([&] { return capture_->state(0).misconfigured; }));
}

}  // namespace
}  // namespace waymark
