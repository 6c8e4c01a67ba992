#include "locd/publish/status_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

Rig two_cameras() {
  Rig rig;
  CameraParameters parameters;
  parameters.width_px = 64;
  parameters.height_px = 48;
  parameters.fu_px = parameters.fv_px = 60;
  for (const char* name : {"cam0", "cam1"}) {
    rig.cameras.push_back({name, *CameraModel::create(parameters), {}, {}, {}, {}, {}, {}});
  }
  return rig;
}

/// Two cameras, cam1 as slow as the test says; a look ten times a second.
class Machine {
 public:
  explicit Machine(Stamp cam1_period) : report_(two_cameras()), cam1_period_(cam1_period) {}

  /// Alerts while time goes on; cam1 delivers or not.
  std::vector<Alert> run(Stamp time, bool cam1_delivers) {
    std::vector<Alert> all;
    for (const Stamp end = now_ + time; now_ < end; now_ += milliseconds(100)) {
      deliver(0, milliseconds(100));
      if (cam1_delivers) deliver(1, cam1_period_);
      report_.judge(states_, now_);
      for (const Alert& alert : report_.camera_alerts(states_, now_, seconds(5))) {
        all.push_back(alert);
      }
    }
    return all;
  }
  StatusReport& report() { return report_; }
  std::vector<RigCapture::CameraState>& states() { return states_; }

 private:
  void deliver(std::size_t c, Stamp period) {
    if (states_[c].frames > 0 && now_ - states_[c].last_frame < period) return;
    ++states_[c].frames;
    states_[c].last_frame = now_;
  }
  StatusReport report_;
  Stamp cam1_period_;
  Stamp now_ = seconds(100);
  std::vector<RigCapture::CameraState> states_{2};
};

TEST(StatusReport, WhatACameraDoesAndWhyItFailsIsNewsOnce) {
  StatusReport report(two_cameras());
  std::vector<RigCapture::CameraState> states(2);
  EXPECT_TRUE(report.camera_news(states).empty());
  states[0].description = "GREY 64×48";
  states[1].error = "absent";
  const auto news = report.camera_news(states);
  ASSERT_EQ(news.size(), 2U);
  EXPECT_EQ(news[0].key, "cam0 runs");
  EXPECT_EQ(news[0].text, "cam0: GREY 64×48");
  EXPECT_EQ(news[1].key, "cam1 fails");
  EXPECT_EQ(news[1].text, "cam1: absent");
  EXPECT_TRUE(report.camera_news(states).empty());
  states[1].error = "";
  EXPECT_TRUE(report.camera_news(states).empty());
  states[1].error = "absent";
  ASSERT_EQ(report.camera_news(states).size(), 1U);
}

TEST(StatusReport, OnlyAWrongConfigurationIsOne) {
  StatusReport report(two_cameras());
  std::vector<RigCapture::CameraState> states(2);
  states[1].error = "absent";
  EXPECT_FALSE(report.misconfiguration(states));
  states[1].misconfigured = true;
  ASSERT_TRUE(report.misconfiguration(states));
  EXPECT_EQ(report.misconfiguration(states)->message, "cam1: absent");
  EXPECT_EQ(report.misconfiguration(states)->kind, ErrorKind::config);
}

TEST(StatusReport, ACameraIsMissingOnceAndOverOnce) {
  Machine machine(milliseconds(100));
  EXPECT_TRUE(machine.run(seconds(5), true).empty());
  const auto gone = machine.run(seconds(5), false);
  ASSERT_EQ(gone.size(), 1U);
  EXPECT_EQ(gone[0].kind, AlertKind::camera_missing);
  EXPECT_TRUE(gone[0].raised);
  EXPECT_EQ(gone[0].camera, 1);
  const auto back = machine.run(seconds(5), true);
  ASSERT_EQ(back.size(), 1U);
  EXPECT_FALSE(back[0].raised);
}

TEST(StatusReport, StampsThatAreNotBelievedAreAnAlertUntilTheyAre) {
  Machine machine(milliseconds(100));
  EXPECT_TRUE(machine.run(seconds(2), true).empty());
  machine.states()[0].unsynced = true;
  const auto begun = machine.run(seconds(2), true);
  ASSERT_EQ(begun.size(), 1U);
  EXPECT_EQ(begun[0].kind, AlertKind::stamps_unsynced);
  EXPECT_TRUE(begun[0].raised);
  EXPECT_EQ(begun[0].camera, 0);
  machine.states()[0].unsynced = false;
  const auto over = machine.run(seconds(2), true);
  ASSERT_EQ(over.size(), 1U);
  EXPECT_FALSE(over[0].raised);
}

TEST(StatusReport, SettingsThatAnotherProgramChangesAreAnAlertAndALineUntilMended) {
  Machine machine(milliseconds(100));
  EXPECT_TRUE(machine.run(seconds(2), true).empty());
  machine.states()[1].changed_settings = "gain was set from 40 to 200 by another program";
  const auto begun = machine.run(seconds(2), true);
  ASSERT_EQ(begun.size(), 1U);
  EXPECT_EQ(begun[0].kind, AlertKind::settings_changed);
  EXPECT_EQ(begun[0].camera, 1);
  const auto news = machine.report().camera_news(machine.states());
  ASSERT_EQ(news.size(), 1U);
  EXPECT_EQ(news[0].key, "cam1 settings");
  EXPECT_EQ(news[0].text, "cam1: gain was set from 40 to 200 by another program");
  machine.states()[1].changed_settings.clear();
  const auto over = machine.run(seconds(2), true);
  ASSERT_EQ(over.size(), 1U);
  EXPECT_FALSE(over[0].raised);
}

TEST(StatusReport, ASlowCameraIsNotMissingBetweenItsFrames) {
  Machine machine(milliseconds(1300));
  EXPECT_FALSE(machine.report().all_run());
  EXPECT_TRUE(machine.run(seconds(30), true).empty());
  EXPECT_TRUE(machine.report().all_run());
  EXPECT_EQ(machine.run(seconds(5), false).size(), 1U);
  EXPECT_FALSE(machine.report().all_run());
}

TEST(StatusReport, ACameraThatNeverCameIsMissingAfterAWhile) {
  Machine machine(milliseconds(100));
  EXPECT_TRUE(machine.run(seconds(5), false).empty());
  EXPECT_EQ(machine.run(seconds(1), false).size(), 1U);
}

TEST(StatusReport, CountsRatesAndDrops) {
  Machine machine(milliseconds(100));
  machine.run(seconds(2), true);
  machine.states()[1].dropped[static_cast<std::size_t>(DropReason::late)] = 3;
  machine.states()[1].damaged = 2;
  machine.states()[1].error = "no such device";
  LocalizationCounts counts;
  counts.sets = 20;
  counts.skipped = 5;
  counts.divisor = 2;
  counts.unhealthy = 0b10;
  counts.left_out[1][static_cast<std::size_t>(DropReason::unhealthy)] = 7;
  counts.left_out[0][static_cast<std::size_t>(DropReason::unsearched)] = 4;
  status_t status{};
  machine.report().fill(machine.states(), counts, seconds(2), status);
  EXPECT_DOUBLE_EQ(status.set_rate_hz, 10);
  EXPECT_DOUBLE_EQ(status.cameras[0].rate_hz, 10);
  EXPECT_EQ(status.cameras[0].dropped, 4);
  EXPECT_EQ(status.cameras[1].dropped, 12);
  EXPECT_EQ(status.cameras[0].usable, 1);
  EXPECT_EQ(status.cameras[1].usable, 0);
  const auto drops = [&](const std::string& reason) {
    const auto found = std::find(status.drop_reason.begin(), status.drop_reason.end(), reason);
    return found == status.drop_reason.end()
               ? -1
               : status.drops[static_cast<std::size_t>(found - status.drop_reason.begin())];
  };
  EXPECT_EQ(drops("late"), 3);
  EXPECT_EQ(drops("damaged"), 2);
  EXPECT_EQ(drops("overload"), 5);
  EXPECT_EQ(drops("unhealthy"), 7);
  EXPECT_EQ(drops("unsearched"), 4);
  EXPECT_EQ(status.drop_count, static_cast<std::int32_t>(status.drops.size()));
  machine.run(seconds(3), false);
  machine.report().fill(machine.states(), counts, seconds(3), status);
  EXPECT_THAT(StatusReport::text(status, "OK 97 % of 30/s, 14 markers, 3 mm"),
              testing::AllOf(testing::StartsWith("OK 97 % of 30/s, 14 markers, 3 mm; "),
                             testing::HasSubstr("one of 2 localized"),
                             testing::HasSubstr("cam1 missing: no such device")));
}

}  // namespace
}  // namespace waymark
