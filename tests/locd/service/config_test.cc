#include "locd/service/config.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/camera_options.h"
#include "locd/frames/stamp_guard.h"
#include "locd/record/recorder.h"
#include "locd/service/setup.h"

namespace waymark {
namespace {

using testing::HasSubstr;

constexpr std::string_view kSmallest =
    "[map]\npath = \"hall.map\"\n"
    "[rig]\ncamchain = \"rig.yaml\"\n"
    "[[camera]]\nname = \"cam0\"\ndriver = \"replay\"\ndevice = \"capture\"\n";

std::string smallest_with(std::string_view more) { return fmt::format("{}\n{}", kSmallest, more); }

TEST(Config, TheSmallestOneHasDefaultsForEverythingElse) {
  const auto config = parse_config(kSmallest, "/etc/locd/locd.toml");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->map, "/etc/locd/hall.map");
  EXPECT_EQ(config->rig.camchain, "/etc/locd/rig.yaml");
  ASSERT_EQ(config->cameras.size(), 1U);
  EXPECT_EQ(config->cameras[0].driver, CameraDriver::replay);
  EXPECT_EQ(config->cameras[0].device, "/etc/locd/capture");
  EXPECT_TRUE(config->sync.triggered);
  EXPECT_EQ(config->lcm.channel_prefix, "WAYMARK");
  EXPECT_EQ(config->lcm.url, "udpm://239.255.76.67:7667?ttl=0");
  EXPECT_FALSE(config->lcm.detections);
  EXPECT_DOUBLE_EQ(config->solve.ok_sigma_m, 0.02);
  EXPECT_DOUBLE_EQ(config->solve.ok_sigma_deg, 0.5);
}

TEST(Config, EveryKeyIsRead) {
  const auto config = parse_config(R"(
[map]
path = "/maps/hall.map"
[rig]
camchain = "/maps/rig.yaml"
base_from_rig = [[0, -1, 0, 0.5], [1, 0, 0, 0.25], [0, 0, 1, 1.5], [0, 0, 0, 1]]
[[camera]]
name = "cam0"
driver = "v4l2"
device = "/dev/v4l/by-id/left"
format = "GREY"
fps = 30
exposure_us = 2000
gain = 4.5
readout_us = 12000
stamp_delay_us = -150
white_balance_k = 4600
focus = 30
power_line_hz = 50
[[camera]]
name = "cam1"
driver = "libcamera"
device = "right"
[sync]
mode = "free"
tolerance_us = 20000
deadline_ms = 40
min_cameras = 2
[solve]
time_budget_ms = 90
ok_sigma_m = 0.01
ok_sigma_deg = 0.2
ok_protection_m = 0.15
ok_protection_deg = 3
v_max_mps = 2
w_max_dps = 60
prior_max_age_s = 0.5
[calibration]
online = false
[lcm]
url = "udpm://239.1.2.3:7777?ttl=1"
channel_prefix = "CART7"
detections = true
[record]
dir = "/data"
codec = "jpeg"
every_nth = 3
max_bytes = 5e9
keep_s = 3600
min_free_bytes = 2000000000
markers = "/maps/markers.toml"
[service]
startup_wait_s = 3
realtime = true
lock_memory = true
)",
                                   "locd.toml");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->map, "/maps/hall.map");
  EXPECT_TRUE((config->rig.base_from_rig * Eigen::Vector3d(1, 0, 0))
                  .isApprox(Eigen::Vector3d(0.5, 1.25, 1.5)));
  ASSERT_EQ(config->cameras.size(), 2U);
  const Config::Camera left{"cam0",
                            CameraDriver::v4l2,
                            "/dev/v4l/by-id/left",
                            "GREY",
                            30,
                            2000.0,
                            4.5,
                            12000.0,
                            -150,
                            4600.0,
                            30.0,
                            50};
  EXPECT_EQ(config->cameras[0], left);
  EXPECT_EQ(config->cameras[1].driver, CameraDriver::libcamera);
  EXPECT_EQ(config->sync, (Config::Sync{false, 20000, 40, 2}));
  EXPECT_EQ(config->solve, (Config::Solve{90, 0.01, 0.2, 0.15, 3, 2, 60, 0.5}));
  EXPECT_FALSE(config->calibration.online);
  EXPECT_EQ(config->lcm, (LcmOptions{"udpm://239.1.2.3:7777?ttl=1", "CART7", true, ""}));
  EXPECT_EQ(config->record, (Config::Record{"/data", true, 3, 5'000'000'000, 3600, 2'000'000'000,
                                            "/maps/markers.toml"}));
  EXPECT_EQ(config->service, (Config::Service{3, true, true}));
}

TEST(Config, WithoutAMapItOnlyRecords) {
  const auto config = parse_config(
      "[rig]\ncamchain = \"rig.yaml\"\n[[camera]]\nname = \"cam0\"\ndriver = \"v4l2\"\ndevice = "
      "\"/dev/video0\"\n",
      "locd.toml");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_TRUE(config->map.empty());
}

struct BadConfig {
  const char* text;
  const char* line;  ///< "line N" where one can be named
  const char* says;
};

class BadConfigs : public testing::TestWithParam<BadConfig> {};

TEST_P(BadConfigs, AreRefusedWithLineAndKey) {
  const auto config = parse_config(smallest_with(GetParam().text), "/etc/locd/locd.toml");
  ASSERT_FALSE(config);
  EXPECT_EQ(config.error().kind, ErrorKind::config);
  EXPECT_THAT(config.error().message, HasSubstr("/etc/locd/locd.toml: line "));
  EXPECT_THAT(config.error().message, HasSubstr(GetParam().line));
  EXPECT_THAT(config.error().message, HasSubstr(GetParam().says));
  EXPECT_EQ(config.error().message.find('\n'), std::string::npos);
}

// The added text begins in line 10.
INSTANTIATE_TEST_SUITE_P(
    Config, BadConfigs,
    testing::Values(
        BadConfig{"[solve]\nok_sigma = 1", "line 11", "unknown key \"ok_sigma\""},
        BadConfig{"[solver]\n", "line 10", "unknown key \"solver\""},
        BadConfig{"[solve]\ntime_budget_ms = 0", "line 11", "time_budget_ms"},
        BadConfig{"[solve]\ntime_budget_ms = nan", "line 11", "time_budget_ms"},
        BadConfig{"[solve]\ntime_budget_ms = \"fast\"", "line 11", "time_budget_ms"},
        BadConfig{"[sync]\nmode = \"auto\"", "line 11", "\"triggered\", \"free\""},
        BadConfig{"[sync]\nmin_cameras = 17", "line 11", "min_cameras"},
        BadConfig{"[sync]\nmin_cameras = 1.5", "line 11", "min_cameras"},
        BadConfig{"[lcm]\nurl = \"tcp://x\"", "line 11", "udpm://"},
        BadConfig{"[lcm]\nurl = \"udpm://239.1.1.1:7?ttl=256\"", "line 11", "ttl"},
        BadConfig{"[lcm]\nurl = \"udpm://239.1.1.1:7?ttl=x\"", "line 11", "ttl"},
        BadConfig{"[lcm]\nurl = \"udpm://192.168.1.10:7667?ttl=1\"", "line 11",
                  "192.168.1.10 is no multicast address (224.0.0.0 to 239.255.255.255)"},
        BadConfig{"[lcm]\nurl = \"udpm://239.255.76.67:7667?tll=1\"", "line 11",
                  "unknown option tll; known: ttl, recv_buf_size"},
        BadConfig{"[lcm]\nchannel_prefix = \"\"", "line 11", "channel_prefix"},
        BadConfig{"[lcm]\nchannel_prefix = \"A\\u0000B\"", "line 11", "channel_prefix"},
        BadConfig{"[lcm]\nchannel_prefix = \"A B\"", "line 11", "channel_prefix"},
        BadConfig{"[lcm]\nchannel_prefix = \"Ä\"", "line 11", "channel_prefix"},
        BadConfig{"[record]\ndir = \"/media/disk\\u0000x\"", "line 11", "dir must be a text"},
        BadConfig{"[record]\nmarkers = \"a\\u0000\"", "line 11", "markers must be a text"},
        BadConfig{"[record]\ncodec = \"png\"", "line 11", "\"pgm\", \"jpeg\""},
        BadConfig{"[record]\nmax_bytes = -1", "line 11", "max_bytes"},
        BadConfig{"[service]\nrealtime = 1", "line 11", "realtime"},
        BadConfig{"[[camera]]\nname = \"cam0\"\ndriver = \"v4l2\"\ndevice = \"x\"", "line 11",
                  "cam0 is named twice"},
        BadConfig{"[[camera]]\nname = \"cam1\"\ndriver = \"usb\"\ndevice = \"x\"", "line 12",
                  "\"v4l2\""},
        BadConfig{"[[camera]]\nname = \"cam1\"\ndriver = \"v4l2\"", "line 10", "device"},
        BadConfig{
            "[[camera]]\nname = \"cam1\"\ndriver = \"v4l2\"\ndevice = "
            "\"serial=1\"\n[[camera]]\nname = \"cam2\"\ndriver = \"v4l2\"\ndevice = \"serial=1\"",
            "line 17", "another camera's already"},
        BadConfig{
            "[[camera]]\nname = \"cam1\"\ndriver = \"v4l2\"\ndevice = \"x\"\npower_line_hz = 55",
            "line 14", "power_line_hz must be 0"},
        BadConfig{"[solve", "line 10", "not valid TOML"}));

TEST(Config, ABaseThatIsNoRigidMotionIsRefused) {
  for (const char* matrix :
       {"[[1,0,0,0],[0,1,0,0],[0,0,1,0]]", "[[1,0,0,0],[0,1,0,0],[0,0,2,0],[0,0,0,1]]",
        "[[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]", "7",
        "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,2]]", "[[1,0,0],[0,1,0],[0,0,1],[0,0,0]]"}) {
    const auto config =
        parse_config(std::string("[rig]\ncamchain = \"r\"\nbase_from_rig = ") + matrix +
                         "\n[[camera]]\nname = \"cam0\"\ndriver = \"v4l2\"\ndevice = \"x\"\n",
                     "locd.toml");
    ASSERT_FALSE(config) << matrix;
    EXPECT_THAT(config.error().message, HasSubstr("line 3: base_from_rig"));
  }
}

TEST(Config, ABaseFarFromItsRigIsRefused) {
  for (const auto& [x_m, taken] :
       {std::pair{"100", true}, {"100.1", false}, {"-1500", false}, {"1e300", false}}) {
    const auto config = parse_config(
        fmt::format("[rig]\ncamchain = \"r\"\nbase_from_rig = [[1,0,0,{}],[0,1,0,0],[0,0,1,0],"
                    "[0,0,0,1]]\n[[camera]]\nname = \"cam0\"\ndriver = \"v4l2\"\ndevice = \"x\"\n",
                    x_m),
        "locd.toml");
    EXPECT_EQ(config.has_value(), taken) << x_m;
    if (taken) continue;
    EXPECT_THAT(config.error().message, HasSubstr("line 3: base_from_rig"));
  }
}

TEST(Config, RigAndCamerasAreNeeded) {
  const auto no_rig =
      parse_config("[[camera]]\nname = \"cam0\"\ndriver = \"v4l2\"\ndevice = \"x\"\n", "l");
  ASSERT_FALSE(no_rig);
  EXPECT_THAT(no_rig.error().message, HasSubstr("camchain"));
  const auto no_camera = parse_config("[rig]\ncamchain = \"rig.yaml\"\n", "l");
  ASSERT_FALSE(no_camera);
  EXPECT_THAT(no_camera.error().message, HasSubstr("[[camera]]"));
}

TEST(Config, MapSolveAndRecordChangeWithoutARestart) {
  const Config now = *parse_config(kSmallest, "locd.toml");
  for (const char* more : {"[solve]\nok_sigma_m = 0.5", "[record]\nevery_nth = 2"}) {
    EXPECT_EQ(key_that_needs_restart(now, *parse_config(smallest_with(more), "locd.toml")),
              std::nullopt);
  }
  Config other_map = now;
  other_map.map = "other.map";
  EXPECT_EQ(key_that_needs_restart(now, other_map), std::nullopt);
}

TEST(Config, EverythingElseNeedsARestartAndIsNamed) {
  const Config now = *parse_config(kSmallest, "locd.toml");
  const auto named = [&](const char* more) {
    return key_that_needs_restart(now, *parse_config(smallest_with(more), "locd.toml"))
        .value_or("none");
  };
  EXPECT_EQ(named("[sync]\ndeadline_ms = 60"), "[sync]");
  EXPECT_EQ(named("[lcm]\nurl = \"memq://\""), "[lcm] url");
  EXPECT_EQ(named("[service]\nrealtime = true"), "[service]");
  EXPECT_EQ(named("[[camera]]\nname = \"cam1\"\ndriver = \"v4l2\"\ndevice = \"x\""), "[[camera]]");
  Config moved = now;
  moved.cameras[0].device = "elsewhere";
  EXPECT_EQ(key_that_needs_restart(now, moved), "[[camera]] of cam0");
  moved = now;
  moved.rig.base_from_rig.translation.x() = 1;
  EXPECT_EQ(key_that_needs_restart(now, moved), "[rig] base_from_rig");
}

struct RangedKey {
  const char* block;
  const char* key;
  Range range;
};

class RangedKeys : public testing::TestWithParam<RangedKey> {
 protected:
  [[nodiscard]] static bool whole() {
    const std::string key = GetParam().key;
    return key == "min_cameras" || key == "every_nth";
  }
  [[nodiscard]] static Expected<Config> with(double value) {
    const std::string block = GetParam().block;
    const std::string line =
        fmt::format("{} = {}\n", GetParam().key,
                    whole() ? fmt::format("{:.0f}", value) : fmt::format("{:.9f}", value));
    if (block == "camera") return parse_config(std::string(kSmallest) + line, "locd.toml");
    return parse_config(smallest_with(fmt::format("[{}]\n{}", block, line)), "locd.toml");
  }
};

TEST_P(RangedKeys, AreHeldToTheRangeOfWhatTheySet) {
  const Range range = GetParam().range;
  for (const double value : {range.low, range.high}) {
    const auto config = with(value);
    ASSERT_TRUE(config) << config.error().message;
    waymark::Setup setup;
    setup.config = *config;
    EXPECT_TRUE(localizer_options(setup).check()) << value;
    EXPECT_TRUE(sync_options(*config).check()) << value;
  }
  const double below = whole() ? 1 : 0.001 * std::abs(range.low) + 1e-6;
  for (const double value : {range.low - below, range.high + (whole() ? 1 : 0.001 * range.high)}) {
    const auto config = with(value);
    ASSERT_FALSE(config) << value;
    EXPECT_THAT(config.error().message, HasSubstr(GetParam().key));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Config, RangedKeys,
    testing::Values(RangedKey{"sync", "tolerance_us", SyncOptions::kTolerance_us},
                    RangedKey{"sync", "deadline_ms", SyncOptions::kDeadline_ms},
                    RangedKey{"sync", "min_cameras", SyncOptions::kMinCameras},
                    RangedKey{"solve", "time_budget_ms", Config::Solve::kTimeBudget_ms},
                    RangedKey{"solve", "ok_sigma_m", GateOptions::kMax3Sigma_m},
                    RangedKey{"solve", "ok_sigma_deg", GateOptions::kMax3Sigma_deg},
                    RangedKey{"solve", "ok_protection_m", GateOptions::kMaxProtection_m},
                    RangedKey{"solve", "ok_protection_deg", GateOptions::kMaxProtection_deg},
                    RangedKey{"solve", "v_max_mps", GateOptions::kVMax_mps},
                    RangedKey{"solve", "w_max_dps", GateOptions::kWMax_degps},
                    RangedKey{"solve", "prior_max_age_s", LocalizerOptions::kPriorMaxAge_s},
                    RangedKey{"camera", "fps", CaptureRequest::kFps},
                    RangedKey{"camera", "exposure_us", CameraControls::kExposure_us},
                    RangedKey{"camera", "gain", CameraControls::kGain},
                    RangedKey{"camera", "readout_us", RigCamera::kReadout_us},
                    RangedKey{"camera", "stamp_delay_us", StampGuardOptions::kDelay_us},
                    RangedKey{"camera", "white_balance_k", CameraControls::kWhiteBalance_k},
                    RangedKey{"camera", "focus", CameraControls::kFocus},
                    RangedKey{"record", "every_nth", RecorderOptions::kEveryNth},
                    RangedKey{"record", "max_bytes", Config::Record::kMaxBytes},
                    RangedKey{"record", "keep_s", Config::Record::kKeep_s},
                    RangedKey{"record", "min_free_bytes", Config::Record::kMinFreeBytes},
                    RangedKey{"service", "startup_wait_s", Config::Service::kStartupWait_s}),
    [](const auto& key) { return std::string(key.param.key); });

TEST(Config, AnAbsentFileIsNoInput) {
  const auto config = read_config("/nonexistent/locd.toml");
  ASSERT_FALSE(config);
  EXPECT_EQ(config.error().kind, ErrorKind::no_input);
}

}  // namespace
}  // namespace waymark
