#include "locd/publish/clock_offset.h"

#include <gtest/gtest.h>

#include <functional>

namespace waymark {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Stamp kToday = seconds(1'800'000'000);
constexpr Stamp kPeriod = milliseconds(100);

/// A machine whose clocks do what the test says.
class FakeClocks {
 public:
  explicit FakeClocks(Stamp wall = kToday) : now_{hours(5), hours(5), wall} {}

  void run(Stamp time, double wall_drift_ppm = 0) {
    now_.monotonic += time;
    now_.boottime += time;
    now_.wall +=
        time +
        Stamp(static_cast<Stamp::rep>(static_cast<double>(time.count()) * wall_drift_ppm * 1e-6));
  }
  void step(Stamp by) { now_.wall += by; }
  void vouch(bool vouched_for) { now_.vouched_for = vouched_for; }
  void suspend(Stamp time) {
    now_.boottime += time;
    now_.wall += time;
  }
  [[nodiscard]] const ClockReading& read() const { return now_; }

 private:
  ClockReading now_;
};

/// Updates for `time` and checks at each that utime runs as the monotonic clock does, to 500 ppm.
void run_checked(FakeClocks& clocks, ClockOffset& offset, Stamp time, double wall_drift_ppm = 0) {
  for (Stamp end = clocks.read().monotonic + time; clocks.read().monotonic < end;) {
    const Stamp before = clocks.read().monotonic + offset.offset();
    clocks.run(kPeriod, wall_drift_ppm);
    offset.update(clocks.read());
    const Stamp advanced = clocks.read().monotonic + offset.offset() - before;
    ASSERT_LE(std::chrono::abs(advanced - kPeriod), kPeriod / 2000);
  }
}

TEST(ClockOffset, IsTheWallClockOnAnUndisturbedMachine) {
  FakeClocks clocks;
  ClockOffset offset(clocks.read());
  run_checked(clocks, offset, hours(1));
  EXPECT_EQ(offset.utime_us(clocks.read().monotonic), clocks.read().wall.count() / 1000);
  EXPECT_EQ(offset.status(), TimeStatus::ok);
  EXPECT_EQ(offset.steps(), 0);
  EXPECT_EQ(offset.error(), Stamp{0});
}

TEST(ClockOffset, FollowsADisciplinedClockWithoutAWord) {
  FakeClocks clocks;
  ClockOffset offset(clocks.read());
  run_checked(clocks, offset, hours(1), 100);
  EXPECT_EQ(offset.status(), TimeStatus::ok);
  EXPECT_EQ(offset.steps(), 0);
  EXPECT_LE(std::chrono::abs(offset.error()), std::chrono::microseconds(1));
}

TEST(ClockOffset, SaysWhenItCannotKeepUpWithASlewedClock) {
  FakeClocks clocks;
  ClockOffset offset(clocks.read());
  run_checked(clocks, offset, seconds(30), 900);  // 0.4 ms/s more than may be followed
  EXPECT_EQ(offset.status(), TimeStatus::slewing);
  EXPECT_EQ(offset.steps(), 0);
  run_checked(clocks, offset, seconds(60));
  EXPECT_EQ(offset.status(), TimeStatus::ok);
}

struct StepCase {
  const char* what;
  Stamp start;
  std::function<void(FakeClocks&)> happens;
  TimeStatus status;
};

class Steps : public testing::TestWithParam<StepCase> {};

TEST_P(Steps, NeverBendTheIntervalsAndAreCounted) {
  FakeClocks clocks(GetParam().start);
  ClockOffset offset(clocks.read());
  run_checked(clocks, offset, seconds(10));
  const Stamp before = offset.offset();
  GetParam().happens(clocks);
  run_checked(clocks, offset, seconds(1));
  EXPECT_EQ(offset.steps(), 1);
  EXPECT_EQ(offset.status(), GetParam().status);
  run_checked(clocks, offset, seconds(9));
  EXPECT_EQ(offset.steps(), 1);
  EXPECT_LE(std::chrono::abs(offset.offset() - before), milliseconds(5));  // 500 ppm of 10 s
}

INSTANTIATE_TEST_SUITE_P(
    ClockOffset, Steps,
    testing::Values(
        StepCase{"an hour on", kToday, [](auto& c) { c.step(hours(1)); }, TimeStatus::stepped},
        StepCase{"an hour back", kToday, [](auto& c) { c.step(-hours(1)); }, TimeStatus::stepped},
        StepCase{"50 ms on", kToday, [](auto& c) { c.step(milliseconds(50)); },
                 TimeStatus::stepped},
        StepCase{"50 ms back", kToday, [](auto& c) { c.step(milliseconds(-50)); },
                 TimeStatus::stepped},
        StepCase{"suspend", kToday, [](auto& c) { c.suspend(hours(8)); }, TimeStatus::suspended},
        StepCase{"1970, set", seconds(40), [](auto& c) { c.step(kToday); }, TimeStatus::unset}));

TEST(ClockOffset, ReturnsToTheWallClockAfterASmallStep) {
  FakeClocks clocks;
  ClockOffset offset(clocks.read());
  clocks.step(milliseconds(50));
  run_checked(clocks, offset, seconds(97));
  EXPECT_EQ(offset.status(), TimeStatus::stepped);
  run_checked(clocks, offset, seconds(2));
  EXPECT_EQ(offset.status(), TimeStatus::ok);
  EXPECT_EQ(offset.steps(), 1);
}

TEST(ClockOffset, TellsStepsFromDriftByFiveMilliseconds) {
  FakeClocks clocks;
  ClockOffset offset(clocks.read());
  clocks.step(milliseconds(4));
  run_checked(clocks, offset, seconds(1));
  EXPECT_EQ(offset.steps(), 0);
  clocks.step(milliseconds(6));
  run_checked(clocks, offset, seconds(1));
  EXPECT_EQ(offset.steps(), 1);
}

TEST(ClockOffset, UtimeRisesThroughAStepBack) {
  FakeClocks clocks;
  ClockOffset offset(clocks.read());
  clocks.step(-hours(1));
  std::int64_t last = offset.utime_us(clocks.read().monotonic);
  for (int i = 0; i < 100; ++i) {
    clocks.run(milliseconds(1));
    offset.update(clocks.read());
    const std::int64_t now = offset.utime_us(clocks.read().monotonic);
    EXPECT_GT(now, last);
    last = now;
  }
}

class Gaps : public testing::TestWithParam<Stamp> {};

TEST_P(Gaps, BetweenReadingsNeverMakeUtimeFall) {
  for (const Stamp wall_step : {Stamp(-hours(1)), Stamp(hours(1)), Stamp(-milliseconds(40))}) {
    FakeClocks clocks;
    ClockOffset offset(clocks.read());
    clocks.step(wall_step);
    run_checked(clocks, offset, seconds(1));
    // A stamp before the reading and one 0.2 ms later, after it.
    const Stamp stamp = clocks.read().monotonic + GetParam();
    const std::int64_t before = offset.utime_us(stamp);
    clocks.run(GetParam());
    offset.update(clocks.read());
    const std::int64_t after = offset.utime_us(stamp + std::chrono::microseconds(200));
    EXPECT_GT(after, before);
    EXPECT_LE(after - before, 200 + 101);
  }
}

INSTANTIATE_TEST_SUITE_P(ClockOffset, Gaps,
                         testing::Values(milliseconds(100), seconds(1), seconds(60), hours(1)));

TEST(ClockOffset, TellsWhatHasHappenedBetweenTwoReadings) {
  FakeClocks clocks;
  ClockOffset offset(clocks.read());
  const auto next = [&] {
    clocks.run(kPeriod);
    return offset.update(clocks.read());
  };
  EXPECT_EQ(next(), ClockEvent::none);
  clocks.step(hours(1));
  EXPECT_EQ(next(), ClockEvent::stepped);
  EXPECT_EQ(next(), ClockEvent::none);
  clocks.suspend(seconds(20));
  EXPECT_EQ(next(), ClockEvent::slept);
  EXPECT_EQ(next(), ClockEvent::none);
}

TEST(ClockOffset, AnUnsetClockIsOneBeforeTwentyTwenty) {
  EXPECT_EQ(ClockOffset(ClockReading{{}, {}, ClockOffset::kEarliestDate}).status(), TimeStatus::ok);
  EXPECT_EQ(ClockOffset(ClockReading{{}, {}, ClockOffset::kEarliestDate - Stamp{1}}).status(),
            TimeStatus::unset);
}

TEST(ClockOffset, UtimeIsADateOnceAServiceKeepsTheClockAndItIsCloseToIt) {
  FakeClocks clocks;
  ClockOffset offset(clocks.read());
  const auto known_after = [&](Stamp step, bool vouched_for) {
    clocks.run(kPeriod);
    clocks.step(step);
    clocks.vouch(vouched_for);
    offset.update(clocks.read());
    return offset.date_known();
  };
  EXPECT_FALSE(offset.date_known());
  EXPECT_TRUE(known_after(seconds(0), true));
  EXPECT_TRUE(known_after(seconds(50), true));
  EXPECT_FALSE(known_after(seconds(20), true));  // utime stays where it was, for hours
  EXPECT_TRUE(known_after(seconds(-70), true));
  EXPECT_FALSE(known_after(seconds(0), false));
}

TEST(ClockOffset, TheMachinesOwnClocksAgree) {
  const ClockReading first = read_clocks();
  ClockOffset offset(first);
  const ClockReading second = read_clocks();
  offset.update(second);
  EXPECT_GE(second.monotonic, first.monotonic);
  EXPECT_EQ(offset.steps(), 0);
}

}  // namespace
}  // namespace waymark
