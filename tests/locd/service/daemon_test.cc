#include "locd/service/daemon.h"

#include <cmath>

#include "core/map/quarantine.h"
#include "tests/locd/service/daemon_fixture.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::DaemonTest;
using testing::HasSubstr;

TEST_F(DaemonTest, APoseGoesOutEveryHalfSecondWithoutFrames) {
  start();
  turn_for(seconds(10));
  ASSERT_GE(poses_.size(), 22U);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    EXPECT_EQ(poses_[i].status, pose_t::LOST);
    EXPECT_EQ(poses_[i].reasons, pose_t::NO_FRAMES);
    EXPECT_TRUE(std::isnan(poses_[i].x_m));
    EXPECT_EQ(poses_[i].seq, static_cast<std::int64_t>(i));
    if (i > 0) {
      // A twentieth of a second is left for a thread that wakes up late.
      EXPECT_LE(poses_[i].utime - poses_[i - 1].utime, 451'000);
    }
  }
}

TEST_F(DaemonTest, EverySetGivesAPose) {
  start();
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(turn_until([&] { return monotonic_now() - last_given_ >= milliseconds(20); }));
    give_set();
    const auto from_frames = [](const pose_t& p) {
      return p.reasons != pose_t::NO_FRAMES && p.reasons != pose_t::OVERLOAD;
    };
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

TEST_F(DaemonTest, ASetThatComesTooLateGivesAPoseThatSaysSo) {
  write_config("[solve]\ntime_budget_ms = 5\n");
  start();
  const auto overloaded = [](const pose_t& p) {
    return p.status == pose_t::LOST && p.reasons == pose_t::OVERLOAD;
  };
  ASSERT_TRUE(turn_until([&] {
    const Stamp now = monotonic_now();
    if (now - last_given_ >= milliseconds(20)) {
      last_given_ = now;
      for (test::FakeCamera* camera : cameras_) camera->give(now - milliseconds(6));
    }
    return std::count_if(poses_.begin(), poses_.end(), overloaded) > 10;
  }));
  ASSERT_TRUE(turn_until([&] { return !statuses_.empty(); }));
  const status_t& status = statuses_.back();
  const auto reason =
      std::find(status.drop_reason.begin(), status.drop_reason.end(), "over_budget");
  ASSERT_NE(reason, status.drop_reason.end());
  EXPECT_GT(status.drops[static_cast<std::size_t>(reason - status.drop_reason.begin())], 0);
}

TEST_F(DaemonTest, StatusComesOnceASecondAndSaysHowTheCamerasAre) {
  start();
  give_set();
  ASSERT_TRUE(turn_until([&] { return !statuses_.empty() && statuses_.back().sets == 1; }));
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
  reload();
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
       "unknown key \"fast\""},
      {"endless key",
       [&](auto& tmp) {
         tmp.write("locd.toml", good_config + "[solve]\n" + std::string(140'000, 'k') + " = 1\n");
       },
       "bytes) …"},
      {"endless key of the rig",
       [&](auto& tmp) {
         tmp.write("rig.yaml", good_rig + "  ? T_" + std::string(140'000, 'k') + "\n  : 1\n");
       },
       "bytes) …"},
      {"orders to systemd and the terminal",
       [&](auto& tmp) {
         tmp.write("rig.yaml", good_rig + "  \"T_x\\nWATCHDOG=trigger\\e[2J\": 1\n");
       },
       "T_x\\nWATCHDOG=trigger\\x1b[2J"}};
  for (const BadReload& bad : cases) {
    bad.spoil(tmp_);
    alerts_.clear();
    reload();
    turn_for(seconds(2));
    const alert_t* const refused = alert("RELOAD", true);
    ASSERT_NE(refused, nullptr) << bad.what;
    EXPECT_THAT(refused->text, HasSubstr(bad.says)) << bad.what;
    EXPECT_EQ(refused->text.find('\n'), std::string::npos) << bad.what;
    EXPECT_THAT(statuses_.back().reload_refused, HasSubstr(bad.says)) << bad.what;
    EXPECT_EQ(statuses_.back().map_hash, content_hash(test::small_map())) << bad.what;
    tmp_.write("hall.map", good_map);
    tmp_.write("rig.yaml", good_rig);
    tmp_.write("locd.toml", good_config);
  }
  reload();
  turn_for(seconds(2));
  EXPECT_EQ(statuses_.back().reload_refused, "");
}

TEST_F(DaemonTest, YawIsToldWhereTheMapSaysThatItsZIsUp) {
  start();
  EXPECT_FALSE(daemon_->telemetry().session().world_z_is_up);
  MarkerMap levelled = test::small_map();
  levelled.submaps[0].z_is_up = true;
  ASSERT_TRUE(write_map_file(tmp_.path() / "hall.map", levelled));
  reload();
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

TEST_F(DaemonTest, PosesAreSignedBesidesWhereThereIsAKey) {
  const auto file = tmp_.write("pose.key", std::string(64, '5'));
  std::filesystem::permissions(file, std::filesystem::perms::owner_read);
  std::string config = tmp_.read("locd.toml");
  tmp_.write("locd.toml",
             config.replace(config.find("[lcm]\n"), 6, "[lcm]\nkey_file = \"pose.key\"\n"));
  start();
  turn_for(seconds(2));
  ASSERT_GE(poses_.size(), 3U);
  ASSERT_EQ(signed_poses_.size(), poses_.size());
  const MessageKey key = *MessageKey::read(file);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const signed_pose_t& message = signed_poses_[i];
    EXPECT_EQ(message.seq, poses_[i].seq);
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(poses_[i].getEncodedSize()));
    poses_[i].encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    EXPECT_EQ(message.pose, bytes);
    signed_pose_t again = message;
    key.sign("WAYMARK_SIGNED_POSE", again);
    EXPECT_TRUE(std::equal(std::begin(message.mac), std::end(message.mac), std::begin(again.mac)));
  }
  tmp_.write("pose.key", std::string(64, '6'));
  reload();
  turn_for(seconds(1));
  ASSERT_NE(alert("RELOAD", true), nullptr);
  EXPECT_THAT(alert("RELOAD", true)->text, testing::HasSubstr("the key has changed"));
}

TEST_F(DaemonTest, WithoutAKeyNothingIsSigned) {
  start();
  turn_for(seconds(1));
  EXPECT_FALSE(poses_.empty());
  EXPECT_TRUE(signed_poses_.empty());
}

}  // namespace
}  // namespace waymark
