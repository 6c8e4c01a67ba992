#include "locd/service/localization_thread.h"

#include <gtest/gtest.h>

#include <deque>
#include <functional>

#include "core/map/map_file.h"
#include "drivers/monotonic_clock.h"
#include "tests/locd/pose/room_drive.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A camera whose frames come with their detections, given by a test.
class RoomCamera final : public FrameSource {
 public:
  explicit RoomCamera(std::string name) : name_(std::move(name)) {}
  void give(Stamp stamp, const ImageDetections* seen) {
    const std::lock_guard lock(mutex_);
    due_.emplace_back(stamp, seen);
    changed_.notify_all();
  }
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] Status start() override { return {}; }
  [[nodiscard]] Expected<std::optional<Frame>> next(Stamp deadline) override {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, as_time_point(deadline), [&] { return stopped_ || !due_.empty(); });
    if (due_.empty()) return std::nullopt;
    FrameInfo info;
    info.stamp = due_.front().first;
    info.arrival = monotonic_now();
    Frame frame(info, {}, due_.front().second, nullptr, 0);
    due_.pop_front();
    return frame;
  }
  void stop() override {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }
  [[nodiscard]] Expected<DeviceReport> inspect() override { return DeviceReport{name_, {}}; }

 private:
  std::string name_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::pair<Stamp, const ImageDetections*>> due_;
  bool stopped_ = false;
};

test::RoomOptions one_camera() {
  test::RoomOptions options;
  options.cameras = 1;
  options.frame_sets = 120;
  options.noise_px = 0.1;
  options.state_covariances = true;
  options.turn_in_place_rad = 0.3;
  return options;
}

/// A localization whose frames and maps a test gives.
class LocalizationThreadTest : public testing::Test {
 protected:
  LocalizationThreadTest()
      : room_(test::make_room(one_camera())),
        telemetry_(lcm(), session(), read_clocks()),
        capture_(sources(), {}),
        thread_(capture_, telemetry_, map_in_use(test::room_map(room_)),
                [](const FrameSetLease& /*set*/, Stamp /*utime_offset*/) {}) {
    telemetry_.lcm()->subscribe("WAYMARK_POSE", &LocalizationThreadTest::take_pose, this);
    telemetry_.lcm()->subscribe("WAYMARK_DETECTIONS", &LocalizationThreadTest::take_detections,
                                this);
    capture_.start();
    thread_.start();
  }
  ~LocalizationThreadTest() override {
    thread_.stop();
    capture_.stop();
  }

  static LcmOptions lcm() {
    LcmOptions lcm;
    lcm.url = "memq://";
    lcm.detections = true;
    return lcm;
  }
  static SessionFacts session() {
    SessionFacts facts;
    facts.session_id = "0123456789abcdef";
    facts.cameras = 1;
    return facts;
  }
  std::vector<std::unique_ptr<FrameSource>> sources() {
    std::vector<std::unique_ptr<FrameSource>> sources;
    auto camera = std::make_unique<RoomCamera>("cam0");
    camera_ = camera.get();
    sources.push_back(std::move(camera));
    return sources;
  }
  [[nodiscard]] MapInUse map_in_use(const MarkerMap& map) const {
    MapInUse use;
    use.identity =
        std::make_shared<const MapIdentity>(MapIdentity{content_hash(map), false, false});
    use.localizer = std::make_unique<Localizer>(room_.rig, map, LocalizerOptions{});
    use.time_budget = seconds(60);
    return use;
  }
  /// The room's map with the marker in the middle of the view 0.3 m from where it hangs.
  [[nodiscard]] MarkerMap wrong_map() const {
    MarkerMap map = test::room_map(room_);
    map.submaps[0].markers[static_cast<std::size_t>(in_view())].world_from_marker.translation.z() +=
        0.3;
    return map;
  }
  [[nodiscard]] int in_view() const {
    std::map<int, int> seen;
    for (const auto& image : room_.images) {
      for (const auto& detection : image.detections) ++seen[detection.marker.number];
    }
    return std::max_element(seen.begin(), seen.end(),
                            [](auto a, auto b) { return a.second < b.second; })
        ->first;
  }

  /// Gives the next image of the room, taken so long ago, and waits until its set is done.
  void give(Stamp ago = Stamp{0}) {
    const std::uint64_t before = thread_.counts().sets;
    // Stamps rise, and by more than what makes frames one set.
    while (monotonic_now() - ago <= last_stamp_ + milliseconds(10)) std::this_thread::yield();
    last_stamp_ = monotonic_now() - ago;
    camera_->give(last_stamp_, &room_.images[given_++ % room_.images.size()]);
    wait_until([&] {
      const LocalizationCounts counts = thread_.counts();
      return counts.sets > before && !counts.at_work;
    });
    while (telemetry_.lcm()->handleTimeout(0) > 0) continue;
  }
  /// Until no pose has an outlier any more, for the marker takes no part.
  void give_until_quarantined() {
    give();
    give();
    ASSERT_GT(poses_.back().outliers, 0);
    for (int i = 0; i < 500 && poses_.back().outliers > 0; ++i) give();
    ASSERT_EQ(poses_.back().outliers, 0);
  }
  template <typename Holds>
  void wait_until(const Holds& holds) {
    const Stamp deadline = monotonic_now() + seconds(20);
    while (!holds()) {
      ASSERT_LT(monotonic_now(), deadline);
      std::this_thread::yield();
    }
  }
  /// What has been told of a quarantine, from maps by their hash.
  void collect() {
    for (LocalizationNews& news : thread_.take_news()) {
      for (const Alert& alert : news.alerts) {
        EXPECT_EQ(alert.kind, AlertKind::marker_moved);
        alerts_of_[news.map->map_hash].push_back(alert);
      }
      if (news.quarantine_changed) quarantine_of_[news.map->map_hash] = news.quarantine;
      if (news.replaced) replaced_.push_back(news.map->map_hash);
    }
  }

  test::SyntheticRoom room_;
  RoomCamera* camera_ = nullptr;
  Telemetry telemetry_;
  RigCapture capture_;
  LocalizationThread thread_;
  std::size_t given_ = 0;
  Stamp last_stamp_{0};
  std::vector<pose_t> poses_;
  std::vector<detections_t> detections_;
  std::map<std::string, std::vector<Alert>> alerts_of_;
  std::map<std::string, std::vector<QuarantinedMarker>> quarantine_of_;
  std::vector<std::string> replaced_;

 private:
  void take_pose(const lcm::ReceiveBuffer* /*b*/, const std::string& /*c*/, const pose_t* pose) {
    poses_.push_back(*pose);
  }
  void take_detections(const lcm::ReceiveBuffer* /*b*/, const std::string& /*c*/,
                       const detections_t* detections) {
    detections_.push_back(*detections);
  }
};

TEST_F(LocalizationThreadTest, ALateSetTellsNothingOfAnEarlierOne) {
  give();
  give();
  ASSERT_EQ(detections_.size(), 2U);
  EXPECT_GT(detections_[1].count, 3);
  give(seconds(0));
  const Stamp in_time = last_stamp_;
  // Older than the budget when it is taken: the thread is given it late.
  MapInUse strict = map_in_use(test::room_map(room_));
  strict.time_budget = Stamp{0};
  thread_.swap_map(std::move(strict));
  wait_until([&] {
    collect();
    return !replaced_.empty();
  });
  give();
  EXPECT_GT(last_stamp_, in_time);
  ASSERT_EQ(poses_.size(), 4U);
  EXPECT_EQ(poses_[3].status, pose_t::LOST);
  EXPECT_EQ(poses_[3].reasons, pose_t::OVERLOAD);
  EXPECT_EQ(poses_[3].markers_used, 0);
  EXPECT_EQ(poses_[3].camera_offset_us[0], 0);
  ASSERT_EQ(detections_.size(), 4U);
  EXPECT_EQ(detections_[3].count, 0);
  EXPECT_EQ(detections_[3].utime, poses_[3].utime);
}

TEST_F(LocalizationThreadTest, WithoutAMapNothingOfAnEarlierSetIsTold) {
  give();
  MapInUse none;
  none.time_budget = seconds(1);
  thread_.swap_map(std::move(none));
  wait_until([&] {
    collect();
    return !replaced_.empty();
  });
  give();
  ASSERT_EQ(detections_.size(), 2U);
  EXPECT_EQ(detections_[1].count, 0);
  EXPECT_EQ(poses_[1].reasons, pose_t::NO_MAP);
}

TEST_F(LocalizationThreadTest, WhatWasFoundWithAMapIsToldOfThatMap) {
  const MarkerMap wrong = wrong_map();
  const std::string hash = content_hash(wrong);
  thread_.swap_map(map_in_use(wrong));
  give_until_quarantined();
  // Nobody has asked meanwhile, and now the right map comes.
  const MarkerMap right = test::room_map(room_);
  thread_.swap_map(map_in_use(right));
  collect();  // makes room for what is to be replaced
  wait_until([&] { return telemetry_.session().map_hash == content_hash(right); });
  for (int i = 0; i < 5; ++i) give();
  collect();
  ASSERT_EQ(alerts_of_[hash].size(), 1U);
  EXPECT_EQ(alerts_of_[hash][0].marker->number, in_view());
  ASSERT_EQ(quarantine_of_[hash].size(), 1U);
  EXPECT_EQ(quarantine_of_[hash][0].marker.number, in_view());
  EXPECT_TRUE(alerts_of_[content_hash(right)].empty());
  EXPECT_TRUE(quarantine_of_[content_hash(right)].empty());
  EXPECT_EQ(replaced_.size(), 2U);
}

TEST_F(LocalizationThreadTest, AQuarantineIsToldOnce) {
  const MarkerMap wrong = wrong_map();
  thread_.swap_map(map_in_use(wrong));
  give_until_quarantined();
  collect();
  collect();
  for (int i = 0; i < 5; ++i) give();
  quarantine_of_.clear();
  collect();
  EXPECT_TRUE(quarantine_of_.empty()) << "told once";
}

}  // namespace
}  // namespace waymark
