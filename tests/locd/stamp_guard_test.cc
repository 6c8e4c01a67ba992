#include "locd/stamp_guard.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

using std::chrono::milliseconds;

Frame frame_at(Stamp stamp) {
  FrameInfo info;
  info.stamp = stamp;
  return Frame(info, {}, nullptr, nullptr, 0);
}

/// 30 frames of 10 ms each, stamped 3 ms before they arrive.
void settle(StampGuard& guard, Stamp& now) {
  for (int i = 0; i < 30; ++i) {
    now += milliseconds(10);
    Frame frame = frame_at(now - milliseconds(3));
    ASSERT_TRUE(guard.admit(frame, now));
    EXPECT_EQ(frame.stamp(), now - milliseconds(3));
    EXPECT_EQ(frame.info().quality, StampQuality::exact);
  }
}

bool admits(Stamp stamp_from_now) {
  StampGuard guard;
  Stamp now = std::chrono::seconds(100);
  settle(guard, now);
  now += milliseconds(10);
  Frame frame = frame_at(now + stamp_from_now);
  return guard.admit(frame, now);
}

TEST(StampGuard, RefusesTheFutureAndWhatIsTooOld) {
  EXPECT_TRUE(admits(milliseconds(1)));
  EXPECT_FALSE(admits(milliseconds(3)));
  EXPECT_TRUE(admits(milliseconds(-12)));
  EXPECT_FALSE(admits(milliseconds(-31)));
  EXPECT_FALSE(admits(milliseconds(-13))) << "the stamp before was that";
}

TEST(StampGuard, TakesTheDelayOff) {
  StampGuardOptions options;
  options.delay = milliseconds(7);
  StampGuard guard(options);
  Frame frame = frame_at(milliseconds(1000));
  ASSERT_TRUE(guard.admit(frame, milliseconds(1000)));
  EXPECT_EQ(frame.stamp(), milliseconds(993));
}

TEST(StampGuard, UsesArrivalWhenStampsStayWrongAndStampsWhenTheyAreFineAgain) {
  StampGuard guard;
  Stamp now = std::chrono::seconds(100);
  settle(guard, now);
  const StampGuardOptions options;
  for (int i = 1; i <= 20; ++i) {  // the camera's clock jumped by an hour
    now += milliseconds(10);
    Frame frame = frame_at(now + std::chrono::hours(1));
    const bool admitted = guard.admit(frame, now);
    EXPECT_EQ(admitted, i >= options.distrust_after) << i;
    if (!admitted) continue;
    EXPECT_EQ(frame.stamp(), now);
    EXPECT_EQ(frame.info().quality, StampQuality::arrival);
  }
  EXPECT_TRUE(guard.unsynced());
  for (int i = 0; i < options.trust_after + 1; ++i) {
    now += milliseconds(10);
    Frame frame = frame_at(now - milliseconds(3));
    (void)guard.admit(frame, now);
  }
  EXPECT_FALSE(guard.unsynced());
}

}  // namespace
}  // namespace waymark
