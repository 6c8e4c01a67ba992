// Reloads as an operator, systemd and a bad disk see them.
#include <sched.h>

#include <condition_variable>
#include <fstream>
#include <map>
#include <mutex>

#include "locd/frames/realtime.h"
#include "tests/locd/service/daemon_fixture.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::DaemonTest;
using test::FakeSystemd;
using testing::HasSubstr;

/// Files on a disk that answers when the test says so.
class StallingDisk {
 public:
  [[nodiscard]] Expected<Setup> load(const std::filesystem::path& config) {
    std::unique_lock lock(mutex_);
    ++asked_;
    ++waiting_;
    changed_.wait(lock, [&] { return !stalls_; });
    --waiting_;
    lock.unlock();
    return load_setup(config);
  }
  void stall() { set(true); }
  void release() { set(false); }
  [[nodiscard]] int asked() const {
    const std::lock_guard lock(mutex_);
    return asked_;
  }
  [[nodiscard]] bool holds_somebody() const {
    const std::lock_guard lock(mutex_);
    return waiting_ > 0;
  }

 private:
  void set(bool stalls) {
    const std::lock_guard lock(mutex_);
    stalls_ = stalls;
    changed_.notify_all();
  }
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stalls_ = false;
  int asked_ = 0;
  int waiting_ = 0;
};

class DaemonReload : public DaemonTest {
 protected:
  DaemonReload() {
    load_setup_ = [this](const std::filesystem::path& config) { return disk_.load(config); };
  }
  ~DaemonReload() override { disk_.release(); }

  void make_ready() {
    start();
    ASSERT_TRUE(turn_until([&] {
      give_set();
      return systemd_->heard().find("READY=1") != std::string::npos;
    }));
  }
  [[nodiscard]] MarkerMap other_map() const {
    MarkerMap other = test::small_map();
    other.submaps[0].markers[0].world_from_marker.translation.x() += 1;
    return other;
  }

  StallingDisk disk_;
};

TEST_F(DaemonReload, ADiskThatStallsHoldsUpNeitherWatchdogNorPosesNorAnswers) {
  FakeSystemd& systemd = with_systemd();
  make_ready();
  disk_.stall();
  daemon_->reload();
  EXPECT_THAT(systemd.heard(), HasSubstr("RELOADING=1"));
  ASSERT_TRUE(turn_until([&] { return disk_.holds_somebody(); }));
  poses_.clear();
  ASSERT_TRUE(turn_until([&] { return systemd.heard().find("WATCHDOG=1") != std::string::npos; }));
  ASSERT_TRUE(turn_until([&] { return !poses_.empty(); }));
  EXPECT_EQ(request("status"), "ok not recording\n");
  turn_for(seconds(60));
  EXPECT_EQ(systemd.heard().find("READY=1"), std::string::npos) << "it is not done";
  EXPECT_EQ(alert("RELOAD", false), nullptr);
  disk_.release();
  ASSERT_TRUE(turn_until([&] { return alert("RELOAD", false) != nullptr; }));
  EXPECT_THAT(systemd.heard(), HasSubstr("READY=1"));
}

TEST_F(DaemonReload, TheEndDoesNotWaitForIt) {
  start();
  disk_.stall();
  daemon_->reload();
  ASSERT_TRUE(turn_until([&] { return disk_.holds_somebody(); }));
  const Stamp before = monotonic_now();
  const Status ended = daemon_->stop(milliseconds(700));
  EXPECT_LT(monotonic_now() - before, seconds(5));
  ASSERT_FALSE(ended);
  EXPECT_THAT(ended.error().message, HasSubstr("a reload"));
  disk_.release();
}

TEST_F(DaemonReload, OfAStormTheNewestWinsAndOneIsDoneAtATime) {
  start();
  disk_.stall();
  daemon_->reload();
  ASSERT_TRUE(turn_until([&] { return disk_.holds_somebody(); }));
  for (int i = 0; i < 1000; ++i) {
    daemon_->reload();
    if (i % 100 == 0) turn_for(milliseconds(100));
  }
  EXPECT_EQ(disk_.asked(), 1);
  ASSERT_TRUE(write_map_file(tmp_.path() / "hall.map", other_map()));
  disk_.release();
  ASSERT_TRUE(turn_until(
      [&] { return !poses_.empty() && poses_.back().map_hash == content_hash(other_map()); }));
  turn_for(seconds(2));
  EXPECT_EQ(disk_.asked(), 2);
  EXPECT_EQ(std::count_if(alerts_.begin(), alerts_.end(),
                          [](const alert_t& alert) { return alert.kind == "RELOAD"; }),
            1);
}

/// This process's threads of that name: how each is scheduled.
std::map<pid_t, std::pair<int, int>> threads_named(const std::string& name) {
  std::map<pid_t, std::pair<int, int>> found;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream comm(task.path() / "comm");
    std::string told;
    std::getline(comm, told);
    if (told != name) continue;
    const auto id = static_cast<pid_t>(std::stoi(task.path().filename().string()));
    sched_param parameters{};
    ::sched_getparam(id, &parameters);
    found[id] = {::sched_getscheduler(id), parameters.sched_priority};
  }
  return found;
}

TEST_F(DaemonReload, DetectionWorkersRunAtLocalizationsPriorityAlsoAfterAReload) {
  const bool permitted = check_realtime().has_value();
  if (permitted) write_config("[service]\nrealtime = true\n");
  // OpenCV's own threads bear the name of the one that first called it, in whatever test.
  const auto earlier = threads_named("detection");
  start();
  const auto expected =
      permitted ? std::pair(SCHED_FIFO, kLocalizationPriority) : std::pair(SCHED_OTHER, 0);
  const std::size_t workers = std::min(2U, std::thread::hardware_concurrency()) - 1;
  const auto as_expected = [&] {
    auto now = threads_named("detection");
    std::erase_if(now, [&](const auto& thread) { return earlier.contains(thread.first); });
    return now.size() == workers && std::all_of(now.begin(), now.end(), [&](const auto& thread) {
             return thread.second == expected;
           });
  };
  EXPECT_TRUE(turn_until(as_expected));
  ASSERT_TRUE(write_map_file(tmp_.path() / "hall.map", other_map()));
  reload();
  EXPECT_TRUE(turn_until([&] {
    return daemon_->telemetry().session().map_hash == content_hash(other_map()) && as_expected();
  }));
}

}  // namespace
}  // namespace waymark
