// The whole daemon under a clock that is wrong, set and slept through.
#include <cmath>

#include "tests/locd/service/daemon_fixture.h"

namespace waymark {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::DaemonTest;
using testing::HasSubstr;

constexpr Stamp kToday = seconds(1'800'000'000);

struct ClockStory {
  const char* what;
  Stamp wall_at_start;
  std::function<void(test::SimulatedClocks&)> happens;
  int status;      ///< status_t::time_status after it
  double error_s;  ///< the machine's clock minus utime then
  bool told;       ///< by a TIME alert
};

class DaemonClocks : public DaemonTest, public testing::WithParamInterface<ClockStory> {
 protected:
  /// The largest and smallest advance of utime from pose to pose, over that of the service's clock.
  void expect_even_utime() {
    ASSERT_GE(poses_.size(), 10U);
    for (std::size_t i = 1; i < poses_.size(); ++i) {
      const auto passed_us = poses_[i].utime - poses_[i - 1].utime;
      EXPECT_GT(passed_us, 0) << i;
      EXPECT_LE(passed_us, 501'000) << i;
    }
  }
};

TEST_P(DaemonClocks, BendNoIntervalAndAreTold) {
  const ClockStory& story = GetParam();
  clocks_.wall_ahead = story.wall_at_start - monotonic_now();
  start();
  turn_for(seconds(5));
  EXPECT_EQ(alert("TIME", true), nullptr);
  ASSERT_FALSE(poses_.empty());
  EXPECT_NEAR(static_cast<double>(poses_[0].utime) * 1e-6,
              std::chrono::duration<double>(story.wall_at_start).count(), 10);
  story.happens(clocks_);
  turn_for(seconds(10));
  expect_even_utime();
  ASSERT_FALSE(statuses_.empty());
  const status_t& status = statuses_.back();
  EXPECT_EQ(status.time_status, story.status);
  EXPECT_EQ(status.time_steps, story.told ? 1 : 0);
  EXPECT_NEAR(status.time_error_s, story.error_s, 0.006);  // 500 ppm of 10 s
  EXPECT_EQ(alert("TIME", true) != nullptr, story.told);
  for (const status_t& each : statuses_) EXPECT_NEAR(each.uptime_s, 7.5, 7.6);
  EXPECT_TRUE(std::is_sorted(statuses_.begin(), statuses_.end(),
                             [](const auto& a, const auto& b) { return a.uptime_s < b.uptime_s; }));
}

INSTANTIATE_TEST_SUITE_P(
    Daemon, DaemonClocks,
    testing::Values(
        ClockStory{"nothing", kToday, [](auto&) {}, status_t::TIME_OK, 0, false},
        ClockStory{"an hour on", kToday, [](auto& c) { c.wall_ahead += hours(1); },
                   status_t::TIME_STEPPED, 3600, true},
        ClockStory{"an hour back", kToday, [](auto& c) { c.wall_ahead -= hours(1); },
                   status_t::TIME_STEPPED, -3600, true},
        ClockStory{"50 ms on", kToday, [](auto& c) { c.wall_ahead += milliseconds(50); },
                   status_t::TIME_STEPPED, 0.045, true},
        ClockStory{"50 ms back", kToday, [](auto& c) { c.wall_ahead -= milliseconds(50); },
                   status_t::TIME_STEPPED, -0.045, true},
        ClockStory{"1970, then set", seconds(60),
                   [](auto& c) { c.wall_ahead += kToday - seconds(60); }, status_t::TIME_UNSET,
                   1.79999994e9, true},
        ClockStory{"1970, never set", seconds(60), [](auto&) {}, status_t::TIME_UNSET, 0, false},
        ClockStory{"253 years ahead, then set", kToday + hours(24 * 365 * 200),
                   [](auto& c) { c.wall_ahead -= hours(24 * 365 * 200); }, status_t::TIME_STEPPED,
                   -200.0 * 365 * 86400, true},
        ClockStory{"eight hours asleep", kToday,
                   [](auto& c) {
                     c.slept += hours(8);
                     c.wall_ahead += hours(8);
                   },
                   status_t::TIME_SUSPENDED, 8 * 3600.0, true}),
    [](const auto& story) {
      std::string name = story.param.what;
      std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
      return name;
    });

/// A service thread that was held up for a minute, while the clock was slewed.
TEST_F(DaemonTest, UtimeDoesNotFallAfterAGap) {
  start();
  turn_for(seconds(3));
  clocks_.wall_ahead -= milliseconds(50);  // a step that utime goes after
  turn_for(seconds(2));
  const std::int64_t before = daemon_->telemetry().utime_us(now_);
  now_ += seconds(60);
  daemon_->turn(now_);
  const std::int64_t after = daemon_->telemetry().utime_us(now_);
  EXPECT_GE(after - before, 60'000'000 - 101);
  EXPECT_LE(after - before, 60'000'000 + 101);
}

}  // namespace
}  // namespace waymark
