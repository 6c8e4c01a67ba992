#include "locd/daemon.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "core/base/descriptor.h"
#include "core/capture/capture_folder.h"
#include "core/map/map_file.h"
#include "core/map/quarantine.h"
#include "tests/support/fake_camera.h"
#include "tests/support/small_map.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::FakeCamera;
using testing::HasSubstr;

/// What systemd would hear.
class FakeSystemd {
 public:
  FakeSystemd() : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    const std::string path = (folder_.path() / "notify").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
    EXPECT_EQ(::bind(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
    ::setenv("WATCHDOG_USEC", "2000000", 1);
  }
  FakeSystemd(const FakeSystemd&) = delete;
  FakeSystemd& operator=(const FakeSystemd&) = delete;
  ~FakeSystemd() {
    ::unsetenv("NOTIFY_SOCKET");
    ::unsetenv("WATCHDOG_USEC");
  }

  /// Listens, as systemd always does: who speaks waits when ten messages are unheard.
  void listen() {
    std::array<char, 4096> buffer{};
    for (ssize_t got = 0; (got = ::recv(socket_.get(), buffer.data(), buffer.size(), 0)) > 0;) {
      heard_.append(buffer.data(), static_cast<std::size_t>(got)).append("\n");
    }
  }
  /// Everything heard since the last call.
  [[nodiscard]] std::string heard() {
    listen();
    return std::exchange(heard_, "");
  }

 private:
  TemporaryFolder folder_;
  Descriptor socket_;
  std::string heard_;
};

/// A daemon with two fake cameras, its messages kept, its service loop turned by hand.
class DaemonTest : public testing::Test {
 protected:
  DaemonTest() {
    write_config("");
    tmp_.write("rig.yaml", tiny_rig_yaml(2));
    tmp_.write("markers.toml", tiny_markers_toml());
    EXPECT_TRUE(write_map_file(tmp_.path() / "hall.map", test::small_map()));
  }
  ~DaemonTest() override {
    if (daemon_ == nullptr) return;
    for (FakeCamera* camera : cameras_) camera->release();
    EXPECT_TRUE(daemon_->stop(seconds(20)));
  }

  void write_config(const std::string& more) {
    tmp_.write("locd.toml",
               "[map]\npath = \"hall.map\"\n[rig]\ncamchain = \"rig.yaml\"\n"
               "[lcm]\nurl = \"memq://\"\n"
               "[[camera]]\nname = \"cam0\"\ndriver = \"v4l2\"\ndevice = \"left\"\n"
               "[[camera]]\nname = \"cam1\"\ndriver = \"v4l2\"\ndevice = \"right\"\n"
               "[record]\ndir = \"recordings\"\nmarkers = \"markers.toml\"\nmin_free_bytes = 0\n" +
                   more);
  }

  void start() {
    auto setup = load_setup(tmp_.path() / "locd.toml");
    ASSERT_TRUE(setup) << setup.error().message;
    std::vector<std::unique_ptr<FrameSource>> sources;
    for (const char* name : {"cam0", "cam1"}) {
      auto camera = std::make_unique<FakeCamera>(name, 64, 48);
      cameras_.push_back(camera.get());
      sources.push_back(std::move(camera));
    }
    DaemonOptions options;
    options.config = tmp_.path() / "locd.toml";
    options.version = "test";
    options.runtime_folder = tmp_.path();
    options.state_folder = tmp_.path();
    daemon_ = std::make_unique<Daemon>(options, std::move(*setup), std::move(sources));
    lcm::LCM& lcm = *daemon_->telemetry().lcm();
    lcm.subscribe("WAYMARK_POSE", &DaemonTest::take_pose, this);
    lcm.subscribe("WAYMARK_STATUS", &DaemonTest::take_status, this);
    lcm.subscribe("WAYMARK_ALERT", &DaemonTest::take_alert, this);
    now_ = monotonic_now();
    ASSERT_TRUE(daemon_->start());
  }

  /// Turns the service loop through `time`, ten times a second, as fast as it goes.
  void turn_for(Stamp time) {
    for (const Stamp end = now_ + time; now_ < end;) {
      now_ += milliseconds(100);
      daemon_->turn(now_);
      if (systemd_) systemd_->listen();
      while (daemon_->telemetry().lcm()->handleTimeout(0) > 0) continue;
    }
  }
  /// Turns until something holds that threads of the daemon bring about.
  template <typename Holds>
  [[nodiscard]] bool turn_until(const Holds& holds) {
    const Stamp deadline = monotonic_now() + seconds(20);
    while (!holds()) {
      if (monotonic_now() > deadline) return false;
      now_ = std::max(now_, monotonic_now());
      daemon_->turn(now_);
      if (systemd_) systemd_->listen();
      while (daemon_->telemetry().lcm()->handleTimeout(0) > 0) continue;
      std::this_thread::yield();
    }
    return true;
  }

  /// A frame of every camera, unless the last were given less than a period ago.
  void give_set() {
    const Stamp stamp = monotonic_now();
    if (stamp - last_given_ < milliseconds(20)) return;
    last_given_ = stamp;
    for (FakeCamera* camera : cameras_) camera->give(stamp);
  }

  /// To be called before start.
  FakeSystemd& with_systemd() { return systemd_.emplace(); }

  [[nodiscard]] const alert_t* alert(const std::string& kind, bool raised) const {
    for (const alert_t& alert : alerts_) {
      if (alert.kind == kind && (alert.raised != 0) == raised) return &alert;
    }
    return nullptr;
  }

  [[nodiscard]] std::string request(const std::string& text) {
    const Descriptor client(::socket(AF_UNIX, SOCK_STREAM, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, (tmp_.path() / "control").c_str(), sizeof address.sun_path - 1);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
    EXPECT_EQ(::connect(client.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    const std::string line = text + "\n";
    EXPECT_EQ(::send(client.get(), line.data(), line.size(), 0), static_cast<ssize_t>(line.size()));
    daemon_->turn(now_ += milliseconds(100));
    std::array<char, 4096> buffer{};
    const ssize_t got = ::recv(client.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    return {buffer.data(), got > 0 ? static_cast<std::size_t>(got) : 0};
  }

  TemporaryFolder tmp_;
  std::optional<FakeSystemd> systemd_;
  std::unique_ptr<Daemon> daemon_;
  std::vector<FakeCamera*> cameras_;
  Stamp now_{0};
  Stamp last_given_{0};
  std::vector<pose_t> poses_;
  std::vector<status_t> statuses_;
  std::vector<alert_t> alerts_;

 private:
  void take_pose(const lcm::ReceiveBuffer* /*b*/, const std::string& /*c*/, const pose_t* pose) {
    poses_.push_back(*pose);
  }
  void take_status(const lcm::ReceiveBuffer* /*b*/, const std::string& /*c*/,
                   const status_t* status) {
    statuses_.push_back(*status);
  }
  void take_alert(const lcm::ReceiveBuffer* /*b*/, const std::string& /*c*/, const alert_t* alert) {
    alerts_.push_back(*alert);
  }
};

TEST_F(DaemonTest, APoseGoesOutEveryHalfSecondWithoutFrames) {
  start();
  turn_for(seconds(10));
  ASSERT_GE(poses_.size(), 20U);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    EXPECT_EQ(poses_[i].status, pose_t::LOST);
    EXPECT_EQ(poses_[i].reasons, pose_t::NO_FRAMES);
    EXPECT_TRUE(std::isnan(poses_[i].x_m));
    EXPECT_EQ(poses_[i].seq, static_cast<std::int64_t>(i));
    if (i > 0) {
      EXPECT_LE(poses_[i].utime - poses_[i - 1].utime, 501'000);
    }
  }
}

TEST_F(DaemonTest, EverySetGivesAPose) {
  start();
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(turn_until([&] { return monotonic_now() - last_given_ >= milliseconds(20); }));
    give_set();
    const auto from_frames = [](const pose_t& p) { return p.reasons != pose_t::NO_FRAMES; };
    ASSERT_TRUE(turn_until(
        [&] { return std::count_if(poses_.begin(), poses_.end(), from_frames) == i + 1; }));
  }
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    EXPECT_EQ(poses_[i].seq, static_cast<std::int64_t>(i));
    EXPECT_EQ(poses_[i].session_id, poses_[0].session_id);
    EXPECT_EQ(poses_[i].map_hash, content_hash(test::small_map()));
    EXPECT_EQ(poses_[i].camera_count, 2);
  }
}

TEST_F(DaemonTest, StatusComesOnceASecondAndSaysHowTheCamerasAre) {
  start();
  give_set();
  ASSERT_TRUE(turn_until([&] { return !statuses_.empty(); }));
  statuses_.clear();
  turn_for(seconds(5));
  EXPECT_EQ(statuses_.size(), 5U);
  const status_t& status = statuses_.back();
  EXPECT_EQ(status.version, "test");
  EXPECT_EQ(status.map_markers, 3);
  ASSERT_EQ(status.camera_count, 2);
  EXPECT_EQ(status.cameras[0].name, "cam0");
  EXPECT_EQ(status.cameras[0].frames, 1);
  EXPECT_EQ(status.sets, 1);
  EXPECT_EQ(status.set_divisor, 1);
  EXPECT_EQ(status.time_status, status_t::TIME_OK);
  EXPECT_GT(status.poses[3], 0);
  EXPECT_EQ(status.publish_failures, 0);
}

TEST_F(DaemonTest, ACameraThatFailsIsNamedAndComesBack) {
  start();
  give_set();
  ASSERT_TRUE(turn_until([&] { return poses_.size() > 1; }));
  cameras_[1]->fail_with("no such device");
  ASSERT_TRUE(turn_until([&] { return alert("MISSING", true) != nullptr; }));
  ASSERT_TRUE(turn_until([&] {
    cameras_[0]->give(monotonic_now());
    return !statuses_.empty() && statuses_.back().cameras[1].state == camera_status_t::LOST;
  }));
  EXPECT_EQ(statuses_.back().cameras[1].error, "no such device");
  EXPECT_THAT(statuses_.back().text, HasSubstr("cam1 missing: no such device"));
  cameras_[1]->fail_with("");
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return std::any_of(alerts_.begin(), alerts_.end(), [](const alert_t& a) {
      return a.kind == "MISSING" && a.raised == 0 && a.subject == "cam1";
    });
  }));
}

TEST_F(DaemonTest, AReloadSwapsTheMap) {
  start();
  MarkerMap other = test::small_map();
  other.submaps[0].markers[0].world_from_marker.translation.x() += 1;
  ASSERT_TRUE(write_map_file(tmp_.path() / "hall.map", other));
  daemon_->reload();
  ASSERT_TRUE(
      turn_until([&] { return !poses_.empty() && poses_.back().map_hash == content_hash(other); }));
  EXPECT_NE(alert("RELOAD", false), nullptr);
  turn_for(seconds(2));
  ASSERT_FALSE(statuses_.empty());
  EXPECT_EQ(statuses_.back().reload_refused, "");
}

struct BadReload {
  const char* what;
  std::function<void(const TemporaryFolder&)> spoil;
  const char* says;
};

TEST_F(DaemonTest, ABadReloadIsRefusedWholeAndSaid) {
  start();
  const std::string good_map = tmp_.read("hall.map");
  const std::string good_rig = tmp_.read("rig.yaml");
  const std::string good_config = tmp_.read("locd.toml");
  std::string newer = good_map;
  newer[8] = 99;  // container version
  const BadReload cases[] = {
      {"damaged map", [&](auto& tmp) { tmp.write("hall.map", good_map.substr(0, 100)); },
       "hall.map"},
      {"newer map", [&](auto& tmp) { tmp.write("hall.map", newer); }, "hall.map"},
      {"absent map", [](auto& tmp) { std::filesystem::remove(tmp.path() / "hall.map"); },
       "hall.map"},
      {"other rig",
       [&](auto& tmp) {
         std::string rig = good_rig;
         tmp.write("rig.yaml", rig.replace(rig.find("60.0"), 4, "61.0"));
       },
       "rig.yaml"},
      {"key for a restart",
       [&](auto& tmp) { tmp.write("locd.toml", good_config + "[sync]\ndeadline_ms = 9\n"); },
       "[sync]"},
      {"unknown key",
       [&](auto& tmp) { tmp.write("locd.toml", good_config + "[solve]\nfast = true\n"); },
       "unknown key \"fast\""}};
  for (const BadReload& bad : cases) {
    bad.spoil(tmp_);
    alerts_.clear();
    daemon_->reload();
    turn_for(seconds(2));
    const alert_t* const refused = alert("RELOAD", true);
    ASSERT_NE(refused, nullptr) << bad.what;
    EXPECT_THAT(refused->text, HasSubstr(bad.says)) << bad.what;
    EXPECT_THAT(statuses_.back().reload_refused, HasSubstr(bad.says)) << bad.what;
    EXPECT_EQ(statuses_.back().map_hash, content_hash(test::small_map())) << bad.what;
    tmp_.write("hall.map", good_map);
    tmp_.write("rig.yaml", good_rig);
    tmp_.write("locd.toml", good_config);
  }
  daemon_->reload();
  turn_for(seconds(2));
  EXPECT_EQ(statuses_.back().reload_refused, "");
}

TEST_F(DaemonTest, RecordsOnRequest) {
  start();
  EXPECT_THAT(request("status"), HasSubstr("not recording"));
  const std::string started = request("start");
  ASSERT_THAT(started, testing::StartsWith("ok "));
  EXPECT_THAT(request("start"), HasSubstr("error"));
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return !statuses_.empty() && statuses_.back().recorded_sets > 3;
  }));
  EXPECT_NE(statuses_.back().recording, 0);
  EXPECT_EQ("ok " + statuses_.back().recording_path + "\n", started);
  EXPECT_THAT(request("stop"), testing::StartsWith("ok "));
  const auto folder = started.substr(3, started.size() - 4);
  const auto capture = open_capture_folder(folder);
  ASSERT_TRUE(capture) << capture.error().message;
  EXPECT_GE(capture->images.size(), 8U);
  EXPECT_THAT(request("shutdown"), HasSubstr("error"));
}

TEST_F(DaemonTest, YawIsToldWhereTheMapSaysThatItsZIsUp) {
  start();
  EXPECT_FALSE(daemon_->telemetry().session().world_z_is_up);
  MarkerMap levelled = test::small_map();
  levelled.submaps[0].z_is_up = true;
  ASSERT_TRUE(write_map_file(tmp_.path() / "hall.map", levelled));
  daemon_->reload();
  EXPECT_TRUE(turn_until([&] { return daemon_->telemetry().session().world_z_is_up; }));
}

TEST_F(DaemonTest, TheQuarantineOfItsMapIsKnownAgain) {
  Quarantine quarantine;
  quarantine.map_hash = content_hash(test::small_map());
  quarantine.markers.push_back(
      {{Family::tag36h11, 12}, QuarantineState::moved, 1'800'000'000'000'000, 0.3});
  ASSERT_TRUE(write_quarantine(tmp_.path() / "quarantine.json", quarantine));
  start();
  turn_for(seconds(2));
  ASSERT_FALSE(statuses_.empty());
  EXPECT_EQ(statuses_.back().quarantined_markers, 1);
}

TEST_F(DaemonTest, TheQuarantineOfAnotherMapIsNot) {
  Quarantine quarantine;
  quarantine.map_hash = "0000000000000000";
  quarantine.markers.push_back({{Family::tag36h11, 12}, QuarantineState::moved, 1, 0.3});
  ASSERT_TRUE(write_quarantine(tmp_.path() / "quarantine.json", quarantine));
  start();
  turn_for(seconds(2));
  ASSERT_FALSE(statuses_.empty());
  EXPECT_EQ(statuses_.back().quarantined_markers, 0);
}

TEST_F(DaemonTest, SystemdHearsReadyStatusAndTheWatchdogsFood) {
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
  turn_for(seconds(2));
  EXPECT_THAT(systemd.heard(), HasSubstr("READY=1"));
}

TEST_F(DaemonTest, TheStartIsExtendedWhileItWaitsForCameras) {
  FakeSystemd& systemd = with_systemd();
  write_config("[service]\nstartup_wait_s = 300\n");
  start();
  turn_for(milliseconds(500));
  EXPECT_THAT(systemd.heard(), HasSubstr("EXTEND_TIMEOUT_USEC=10000000"));
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
  cameras_[0]->get_stuck();
  turn_for(seconds(1));
  EXPECT_THAT(systemd.heard(), HasSubstr("WATCHDOG=1"));
  turn_for(seconds(5));  // the camera's last turn lies behind by so much
  (void)systemd.heard();
  turn_for(seconds(1));
  EXPECT_EQ(systemd.heard().find("WATCHDOG=1"), std::string::npos);
}

TEST_F(DaemonTest, TheEndDoesNotWaitForAStuckDriver) {
  start();
  cameras_[0]->get_stuck();
  ASSERT_TRUE(turn_until([&] {  // it is in the call
    cameras_[0]->give(monotonic_now());
    return cameras_[0]->lent() == 0 && poses_.size() > 2;
  }));
  const Stamp before = monotonic_now();
  EXPECT_FALSE(daemon_->stop(milliseconds(200)));
  EXPECT_LT(monotonic_now() - before, seconds(1));
}

}  // namespace
}  // namespace waymark
