#include "locd/frames/stamp_guard.h"

#include <gtest/gtest.h>

#include "tests/support/expect_ranges.h"

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

/// Whether a stamp that rises is admitted at this age, after a gap that leaves room for both.
bool admits_after_gap(Stamp age) {
  StampGuard guard;
  Stamp now = std::chrono::seconds(100);
  settle(guard, now);
  now += milliseconds(300);
  Frame frame = frame_at(now - age);
  return guard.admit(frame, now);
}

TEST(StampGuard, RefusesWhatIsOlderThanThreePeriodsThoughItRises) {
  EXPECT_TRUE(admits_after_gap(milliseconds(29)));
  EXPECT_FALSE(admits_after_gap(milliseconds(31)));
}

/// Frames of 33 ms that say the truth, as they arrive after 300 ms in which nobody took them: those
/// that the driver had buffers for at once, then the rest in time.
TEST(StampGuard, FramesThatWaitedForUsAreNoReasonForDistrust) {
  StampGuard guard;
  const Stamp period = milliseconds(33);
  const Stamp transfer = milliseconds(3);
  Stamp taken = std::chrono::seconds(100);
  const auto arrives = [&](Stamp arrival) {
    Frame frame = frame_at(taken);
    const bool admitted = guard.admit(frame, arrival);
    EXPECT_FALSE(guard.unsynced());
    if (admitted) {
      EXPECT_EQ(frame.stamp(), taken);
      EXPECT_EQ(frame.info().quality, StampQuality::exact);
    }
    taken += period;
    return admitted;
  };
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(arrives(taken + transfer));
  for (int stall = 0; stall < 3; ++stall) {
    Stamp now = taken - period + transfer + milliseconds(300);
    for (int i = 0; i < 5; ++i, now += milliseconds(1)) static_cast<void>(arrives(now));
    while (taken + transfer < now) taken += period;  // overwritten
    for (int i = 0; i < 30; ++i) EXPECT_TRUE(arrives(taken + transfer)) << i;
  }
}

TEST(StampGuard, ALastingChangeOfTheRateIsLearned) {
  StampGuard guard;
  Stamp now = std::chrono::seconds(100);
  settle(guard, now);
  for (const Stamp period : {milliseconds(100), milliseconds(5)}) {
    int refused = 0;
    for (int i = 0; i < 100; ++i) {
      now += period;
      Frame frame = frame_at(now - period);
      refused += guard.admit(frame, now) ? 0 : 1;
      ASSERT_FALSE(guard.unsynced());
    }
    EXPECT_LT(refused, 5);
    // Three periods are again what is too old, and a clock that is wrong is found out.
    Frame old = frame_at(now + period / 2 - 4 * period);
    EXPECT_FALSE(guard.admit(old, now += period / 2));
  }
  const StampGuardOptions options;
  for (int i = 0; i < options.distrust_after; ++i) {
    now += milliseconds(5);
    Frame frame = frame_at(now + std::chrono::hours(1));
    static_cast<void>(guard.admit(frame, now));
  }
  EXPECT_TRUE(guard.unsynced());
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

TEST(StampGuardOptions, AreHeldToTheirRanges) {
  using Options = StampGuardOptions;
  expect_ranges<Options>({ranged("delay in us", &Options::delay, Options::kDelay_us, 1),
                          ranged("future in ms", &Options::future, {0, 100}, 1000),
                          ranged("oldest_periods", &Options::oldest_periods, {1, 100}),
                          ranged("distrust_after", &Options::distrust_after, {1, 1000}),
                          ranged("trust_after", &Options::trust_after, {1, 10'000})});
}

}  // namespace
}  // namespace waymark
