#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/descriptor.h"
#include "core/map/map_file.h"
#include "locd/service/daemon.h"
#include "tests/support/fake_camera.h"
#include "tests/support/small_map.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark::test {

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

  /// Listens, as systemd always does: who speaks waits when ten messages are unheard. Of a datagram
  /// longer than the buffer systemd takes nothing.
  void listen() {
    std::array<char, 4096> buffer{};
    for (ssize_t got = 0;
         (got = ::recv(socket_.get(), buffer.data(), buffer.size(), MSG_TRUNC)) > 0;) {
      const auto bytes = static_cast<std::size_t>(got);
      if (bytes > buffer.size()) continue;
      const std::string datagram(buffer.data(), bytes);
      datagrams_.push_back(datagram);
      heard_.append(datagram).append("\n");
    }
  }
  /// All that was ever heard.
  [[nodiscard]] const std::vector<std::string>& datagrams() {
    listen();
    return datagrams_;
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
  std::vector<std::string> datagrams_;
};

/// The machine's clocks under a test's hand: CLOCK_MONOTONIC is the service loop's, the others run
/// ahead of it by what the test says.
struct SimulatedClocks {
  Stamp wall_ahead = std::chrono::seconds(1'800'000'000);
  Stamp slept{0};
  bool vouched_for = false;

  [[nodiscard]] ClockReading at(Stamp monotonic) const {
    return {monotonic, monotonic + slept, monotonic + wall_ahead, vouched_for};
  }
};

/// A daemon with two fake cameras, its messages kept, its service loop turned by hand.
class DaemonTest : public testing::Test {
 protected:
  DaemonTest() {
    write_config("");
    tmp_.write("rig.yaml", tiny_rig_yaml(2));
    tmp_.write("markers.toml", tiny_markers_toml());
    EXPECT_TRUE(write_map_file(tmp_.path() / "hall.map", small_map()));
  }
  ~DaemonTest() override {
    if (daemon_ == nullptr) return;
    for (FakeCamera* camera : cameras_) camera->release();
    EXPECT_TRUE(daemon_->stop(std::chrono::seconds(20)));
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

  /// `prepare`: done to each camera before.
  void start(const std::function<void(FakeCamera&)>& prepare = [](FakeCamera& /*camera*/) {}) {
    make(prepare);
    ASSERT_TRUE(daemon_->start());
  }
  /// One that is not started yet. `record`: recorded from the start, here.
  void make(const std::function<void(FakeCamera&)>& prepare,
            const std::optional<std::filesystem::path>& record = std::nullopt) {
    auto setup = load_setup(tmp_.path() / "locd.toml");
    ASSERT_TRUE(setup) << setup.error().message;
    std::vector<std::unique_ptr<FrameSource>> sources;
    for (const char* name : {"cam0", "cam1"}) {
      auto camera = std::make_unique<FakeCamera>(name, 64, 48);
      prepare(*camera);
      cameras_.push_back(camera.get());
      sources.push_back(std::move(camera));
    }
    DaemonOptions options;
    options.config = tmp_.path() / "locd.toml";
    options.record = record;
    options.version = "test";
    options.runtime_folder = tmp_.path();
    options.state_folder = tmp_.path();
    now_ = monotonic_now();
    options.read_clocks = [this] { return clocks_.at(now_); };
    options.load_setup = load_setup_;
    daemon_ = std::make_unique<Daemon>(options, std::move(*setup), std::move(sources));
    lcm::LCM& lcm = *daemon_->telemetry().lcm();
    lcm.subscribe("WAYMARK_POSE", &DaemonTest::take_pose, this);
    lcm.subscribe("WAYMARK_SIGNED_POSE", &DaemonTest::take_signed_pose, this);
    lcm.subscribe("WAYMARK_STATUS", &DaemonTest::take_status, this);
    lcm.subscribe("WAYMARK_ALERT", &DaemonTest::take_alert, this);
  }

  /// Turns the service loop through `time`, ten times a second, as fast as it goes.
  void turn_for(Stamp time) {
    for (const Stamp end = now_ + time; now_ < end;) {
      const Stamp due = daemon_->telemetry().next_keep_alive();
      now_ = std::max(now_, std::min(now_ + std::chrono::milliseconds(100), due));
      daemon_->turn(now_);
      if (systemd_) systemd_->listen();
      while (daemon_->telemetry().lcm()->handleTimeout(0) > 0) continue;
    }
  }
  /// Turns as the service loop does, in true time: for what depends on the clock of threads.
  void serve_for(Stamp time) {
    for (const Stamp end = monotonic_now() + time; (now_ = monotonic_now()) < end;) {
      daemon_->turn(now_);
      if (systemd_) systemd_->listen();
      while (daemon_->telemetry().lcm()->handleTimeout(0) > 0) continue;
      pollfd request{daemon_->control_descriptor(), POLLIN, 0};
      ::poll(&request, 1, 100);
    }
  }
  /// Turns until something holds that threads of the daemon bring about.
  template <typename Holds>
  [[nodiscard]] bool turn_until(const Holds& holds) {
    const Stamp deadline = monotonic_now() + std::chrono::seconds(20);
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

  /// Has the configuration read again and waits until it was swapped in or refused.
  void reload() {
    const auto told = [&] {
      return std::count_if(alerts_.begin(), alerts_.end(),
                           [](const alert_t& alert) { return alert.kind == "RELOAD"; });
    };
    const auto before = told();
    daemon_->reload();
    ASSERT_TRUE(turn_until([&] { return told() > before; }));
  }

  /// A frame of every camera, unless the last were given less than a period ago.
  void give_set() {
    const Stamp stamp = monotonic_now();
    if (stamp - last_given_ < std::chrono::milliseconds(20)) return;
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

  /// A line on the control socket; its answer comes with later turns.
  [[nodiscard]] Descriptor ask(const std::string& text) const {
    Descriptor client(::socket(AF_UNIX, SOCK_STREAM, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, (tmp_.path() / "control").c_str(), sizeof address.sun_path - 1);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
    EXPECT_EQ(::connect(client.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    const std::string line = text + "\n";
    EXPECT_EQ(::send(client.get(), line.data(), line.size(), 0), static_cast<ssize_t>(line.size()));
    return client;
  }
  /// What has come so far.
  [[nodiscard]] static std::string answer_to(const Descriptor& client) {
    std::array<char, 4096> buffer{};
    const ssize_t got = ::recv(client.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    return {buffer.data(), got > 0 ? static_cast<std::size_t>(got) : 0};
  }
  [[nodiscard]] std::string request(const std::string& text) {
    const Descriptor client = ask(text);
    std::string answer;
    EXPECT_TRUE(turn_until([&] { return !(answer += answer_to(client)).empty(); }));
    return answer;
  }

  TemporaryFolder tmp_;
  std::optional<FakeSystemd> systemd_;
  std::unique_ptr<Daemon> daemon_;
  std::vector<FakeCamera*> cameras_;
  SimulatedClocks clocks_;
  /// How reloads read; the start itself has read already.
  std::function<Expected<waymark::Setup>(const std::filesystem::path&)> load_setup_ = load_setup;
  Stamp now_{0};
  Stamp last_given_{0};
  std::vector<pose_t> poses_;
  std::vector<signed_pose_t> signed_poses_;
  std::vector<status_t> statuses_;
  std::vector<alert_t> alerts_;

 private:
  void take_pose(const lcm::ReceiveBuffer* /*b*/, const std::string& /*c*/, const pose_t* pose) {
    poses_.push_back(*pose);
  }
  void take_signed_pose(const lcm::ReceiveBuffer* /*b*/, const std::string& /*c*/,
                        const signed_pose_t* pose) {
    signed_poses_.push_back(*pose);
  }
  void take_status(const lcm::ReceiveBuffer* /*b*/, const std::string& /*c*/,
                   const status_t* status) {
    statuses_.push_back(*status);
  }
  void take_alert(const lcm::ReceiveBuffer* /*b*/, const std::string& /*c*/, const alert_t* alert) {
    alerts_.push_back(*alert);
  }
};

}  // namespace waymark::test
