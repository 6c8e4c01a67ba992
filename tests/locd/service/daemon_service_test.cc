// The daemon as systemd sees it: ready, fed, refused, ended.
#include "tests/locd/service/daemon_fixture.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::DaemonTest;
using test::FakeSystemd;
using testing::HasSubstr;

TEST_F(DaemonTest, SystemdHearsReadyStatusAndTheWatchdog) {
  FakeSystemd& systemd = with_systemd();
  start();
  EXPECT_EQ(systemd.heard().find("READY=1"), std::string::npos);
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return systemd.heard().find("READY=1") != std::string::npos;
  }));
  ASSERT_TRUE(turn_until([&] { return systemd.heard().find("STATUS=") != std::string::npos; }));
  ASSERT_TRUE(turn_until([&] { return systemd.heard().find("WATCHDOG=1") != std::string::npos; }));
  daemon_->reload();
  EXPECT_THAT(systemd.heard(), HasSubstr("RELOADING=1"));
}

TEST_F(DaemonTest, AMissingCameraNeverFailsTheStart) {
  FakeSystemd& systemd = with_systemd();
  write_config("[service]\nstartup_wait_s = 1\n");
  start();
  turn_for(seconds(3));
  EXPECT_THAT(systemd.heard(), HasSubstr("READY=1"));
}

TEST_F(DaemonTest, TheStartIsExtendedWhileItWaitsForCameras) {
  FakeSystemd& systemd = with_systemd();
  write_config("[service]\nstartup_wait_s = 300\n");
  start();
  turn_for(milliseconds(500));
  EXPECT_THAT(systemd.heard(), HasSubstr("EXTEND_TIMEOUT_USEC=10000000"));
}

TEST_F(DaemonTest, AReloadBeforeReadyDoesNotMakeItReady) {
  FakeSystemd& systemd = with_systemd();
  write_config("[service]\nstartup_wait_s = 300\n");
  start();
  reload();
  turn_for(seconds(2));
  const std::string heard = systemd.heard();
  EXPECT_THAT(heard, HasSubstr("STATUS=reloaded"));
  EXPECT_EQ(heard.find("RELOADING=1"), std::string::npos);  // only READY=1 would end that
  EXPECT_EQ(heard.find("READY=1"), std::string::npos);
}

TEST_F(DaemonTest, ACameraThatOnlyAnotherConfigurationMendsRefusesTheStart) {
  FakeSystemd& systemd = with_systemd();
  start();
  cameras_[1]->fail_with("has serial number 1, the rig 2", ErrorKind::config);
  ASSERT_TRUE(turn_until([&] { return daemon_->refusal().has_value(); }));
  EXPECT_EQ(daemon_->refusal()->kind, ErrorKind::config);
  EXPECT_EQ(daemon_->refusal()->message, "cam1: has serial number 1, the rig 2");
  EXPECT_EQ(systemd.heard().find("READY=1"), std::string::npos);
}

TEST_F(DaemonTest, AWrongCameraRefusesTheStartAlsoOfAServiceThatWaitsForNone) {
  FakeSystemd& systemd = with_systemd();
  write_config("[service]\nstartup_wait_s = 0\n");
  start([](test::FakeCamera& camera) {
    camera.fail_with("has serial number 1, the rig 2", ErrorKind::config);
    camera.get_stuck();  // its first start takes a while
  });
  now_ = monotonic_now();
  daemon_->turn(now_);
  EXPECT_EQ(systemd.heard().find("READY=1"), std::string::npos);
  for (test::FakeCamera* camera : cameras_) camera->release();
  EXPECT_TRUE(turn_until([&] { return daemon_->refusal().has_value(); }));
  EXPECT_EQ(systemd.heard().find("READY=1"), std::string::npos);
}

TEST_F(DaemonTest, ARigFileOfManyUnknownKeysIsToldInFewLines) {
  std::string rig = tiny_rig_yaml(2);
  for (int i = 0; i < 5'000; ++i) rig += "  key_" + std::to_string(i) + ": 1\n";
  tmp_.write("rig.yaml", rig);
  testing::internal::CaptureStderr();
  start();
  const std::string lines = testing::internal::GetCapturedStderr();
  EXPECT_THAT(lines, HasSubstr("more like these"));
  EXPECT_LT(std::count(lines.begin(), lines.end(), '\n'), 40);
}

TEST_F(DaemonTest, OnceReadyAWrongCameraIsAMissingOne) {
  FakeSystemd& systemd = with_systemd();
  start();
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return systemd.heard().find("READY=1") != std::string::npos;
  }));
  cameras_[1]->fail_with("has serial number 1, the rig 2", ErrorKind::config);
  ASSERT_TRUE(turn_until([&] {
    cameras_[0]->give(monotonic_now());
    return alert("MISSING", true) != nullptr;
  }));
  EXPECT_FALSE(daemon_->refusal());
}

TEST_F(DaemonTest, TheWatchdogStarvesWhenACameraIsStuckInACall) {
  FakeSystemd& systemd = with_systemd();
  start();
  const auto fed = [&] { return systemd.heard().find("WATCHDOG=1") != std::string::npos; };
  serve_for(seconds(4));  // no longer because it has only just been started
  (void)systemd.heard();
  ASSERT_TRUE(turn_until(fed));
  cameras_[0]->get_stuck();
  serve_for(seconds(4));
  (void)systemd.heard();
  serve_for(seconds(2));  // twice the time after which it would be due
  EXPECT_FALSE(fed());
  cameras_[0]->release();
  EXPECT_TRUE(turn_until(fed)) << "something else has kept it from being fed";
}

TEST_F(DaemonTest, TheEndDoesNotWaitForAStuckDriver) {
  start();
  cameras_[0]->get_stuck();
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return cameras_[0]->is_stuck() && poses_.size() > 2;
  }));
  const Stamp before = monotonic_now();
  EXPECT_FALSE(daemon_->stop(milliseconds(200)));
  EXPECT_LT(monotonic_now() - before, seconds(5));
}

}  // namespace
}  // namespace waymark
