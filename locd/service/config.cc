#include "locd/service/config.h"

#include <algorithm>

#include "core/base/toml_fields.h"
#include "core/camera/kalibr.h"
#include "drivers/camera_options.h"
#include "locd/frames/frame_synchronizer.h"
#include "locd/frames/stamp_guard.h"
#include "locd/pose/localizer.h"
#include "locd/publish/lcm_url.h"
#include "locd/record/recorder.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// One locd.toml, block by block; the first error of any block wins.
class ConfigReader {
 public:
  ConfigReader(const toml::table& root, const fs::path& name)
      : root_(root), name_(name.string()), folder_(name.parent_path()) {}

  Expected<Config> read() {
    TomlFields blocks(root_, name_, ErrorKind::config);
    read_map(blocks.table("map"));
    read_rig(blocks.table("rig"));
    for (const toml::table* camera : blocks.tables("camera")) read_camera(*camera);
    read_sync(blocks.table("sync"));
    read_solve(blocks.table("solve"));
    read_calibration(blocks.table("calibration"));
    read_lcm(blocks.table("lcm"));
    read_record(blocks.table("record"));
    read_service(blocks.table("service"));
    if (config_.rig.camchain.empty()) blocks.reject("[rig] camchain is missing");
    if (config_.cameras.empty()) blocks.reject("there is no [[camera]] block");
    keep(blocks.finish());
    if (first_error_) return tl::make_unexpected(*first_error_);
    return config_;
  }

 private:
  void keep(const Status& status) {
    if (!status && !first_error_) first_error_ = status.error();
  }

  /// Runs `read` on the block's fields, where the block is there.
  template <typename Read>
  void in_block(const toml::table* table, const Read& read) {
    if (table == nullptr) return;
    TomlFields fields(*table, name_, ErrorKind::config);
    read(fields);
    keep(fields.finish());
  }

  fs::path file(TomlFields& fields, std::string_view key, const fs::path& fallback) {
    const fs::path named = fields.text(key, fallback.string());
    return named.empty() || named.is_absolute() ? named : folder_ / named;
  }

  void read_map(const toml::table* table) {
    in_block(table, [&](TomlFields& f) {
      config_.map = file(f, "path", {});
      if (config_.map.empty()) f.reject("path is missing; leave [map] out to only record");
    });
  }

  void read_rig(const toml::table* table) {
    in_block(table, [&](TomlFields& f) {
      config_.rig.camchain = file(f, "camchain", {});
      f.allow("base_from_rig");
      const toml::node* matrix = f.has("base_from_rig") ? table->get("base_from_rig") : nullptr;
      if (matrix != nullptr) read_base_from_rig(f, *matrix);
    });
  }

  void read_base_from_rig(TomlFields& fields, const toml::node& node) {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Constant(std::numeric_limits<double>::quiet_NaN());
    const toml::array* rows = node.as_array();
    for (std::size_t r = 0; rows != nullptr && r < rows->size() && r < 4; ++r) {
      const toml::array* row = rows->get(r)->as_array();
      for (std::size_t c = 0; row != nullptr && row->size() == 4 && c < 4; ++c) {
        matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) =
            row->get(c)->value<double>().value_or(std::numeric_limits<double>::quiet_NaN());
      }
    }
    const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
    const bool rigid =
        rows != nullptr && rows->size() == 4 && matrix.allFinite() &&
        (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < 1e-9 &&
        (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <=
            1e-3 &&
        rotation.determinant() > 0;
    if (!rigid) {
      fields.reject("base_from_rig",
                    "base_from_rig must be 4 rows of 4 numbers: a rotation, a "
                    "translation in m, and 0 0 0 1 below");
      return;
    }
    if (matrix.topRightCorner<3, 1>().norm() > kMaxBaseline_m) {
      fields.reject("base_from_rig",
                    fmt::format("base_from_rig: the base is further than {} m from the rig; it "
                                "must be in metres; is it in millimetres?",
                                kMaxBaseline_m));
      return;
    }
    config_.rig.base_from_rig = {Eigen::Quaterniond(rotation).normalized(),
                                 matrix.topRightCorner<3, 1>()};
  }

  void read_camera(const toml::table& table) {
    in_block(&table, [&](TomlFields& f) {
      Config::Camera camera;
      camera.name = f.text("name");
      camera.driver =
          static_cast<CameraDriver>(f.choice("driver", {"v4l2", "libcamera", "replay"}));
      camera.device = f.text("device");
      if (camera.driver == CameraDriver::replay) camera.device = (folder_ / camera.device).string();
      camera.format = f.text("format", "");
      camera.fps = number(f, "fps", CaptureRequest::kFps, 0.0);
      camera.exposure_us = optional_number(f, "exposure_us", CameraControls::kExposure_us);
      camera.gain = optional_number(f, "gain", CameraControls::kGain);
      camera.readout_us = optional_number(f, "readout_us", RigCamera::kReadout_us);
      camera.stamp_delay_us = number(f, "stamp_delay_us", StampGuardOptions::kDelay_us, 0.0);
      camera.white_balance_k =
          optional_number(f, "white_balance_k", CameraControls::kWhiteBalance_k);
      camera.focus = optional_number(f, "focus", CameraControls::kFocus);
      read_power_line(f, camera);
      const auto same_name = [&](const auto& other) { return other.name == camera.name; };
      if (std::any_of(config_.cameras.begin(), config_.cameras.end(), same_name)) {
        f.reject("name", fmt::format("{} is named twice", camera.name));
      }
      const auto same_device = [&](const auto& other) {
        return camera.driver != CameraDriver::replay && other.driver == camera.driver &&
               other.device == camera.device;
      };
      if (std::any_of(config_.cameras.begin(), config_.cameras.end(), same_device)) {
        f.reject("device", fmt::format("{} is another camera's already", camera.device));
      }
      config_.cameras.push_back(camera);
    });
  }

  static void read_power_line(TomlFields& fields, Config::Camera& camera) {
    const auto hz = optional_number(fields, "power_line_hz", {0, 60});
    if (!hz) return;
    if (!CameraControls::is_power_line_hz(*hz)) {
      fields.reject("power_line_hz", "power_line_hz must be 0 (off), 50 or 60");
    }
    camera.power_line_hz = static_cast<int>(*hz);
  }

  static std::optional<double> optional_number(TomlFields& fields, std::string_view key,
                                               const Range& range) {
    if (fields.has(key)) return fields.number(key, range.low, range.high);
    fields.allow(key);
    return std::nullopt;
  }

  static double number(TomlFields& fields, std::string_view key, const Range& range,
                       double fallback) {
    return fields.number(key, range.low, range.high, fallback);
  }

  static int integer(TomlFields& fields, std::string_view key, const Range& range, int fallback) {
    return fields.integer(key, static_cast<int>(range.low), static_cast<int>(range.high), fallback);
  }

  void read_sync(const toml::table* table) {
    in_block(table, [&](TomlFields& f) {
      Config::Sync& sync = config_.sync;
      sync.triggered = f.choice("mode", {"triggered", "free"}, 0) == 0;
      sync.tolerance_us = number(f, "tolerance_us", SyncOptions::kTolerance_us, sync.tolerance_us);
      sync.deadline_ms = number(f, "deadline_ms", SyncOptions::kDeadline_ms, sync.deadline_ms);
      sync.min_cameras = integer(f, "min_cameras", SyncOptions::kMinCameras, sync.min_cameras);
    });
  }

  void read_solve(const toml::table* table) {
    in_block(table, [&](TomlFields& f) {
      Config::Solve& solve = config_.solve;
      solve.time_budget_ms =
          number(f, "time_budget_ms", Config::Solve::kTimeBudget_ms, solve.time_budget_ms);
      solve.ok_sigma_m = number(f, "ok_sigma_m", GateOptions::kMax3Sigma_m, solve.ok_sigma_m);
      solve.ok_sigma_deg =
          number(f, "ok_sigma_deg", GateOptions::kMax3Sigma_deg, solve.ok_sigma_deg);
      solve.ok_protection_m =
          number(f, "ok_protection_m", GateOptions::kMaxProtection_m, solve.ok_protection_m);
      solve.ok_protection_deg =
          number(f, "ok_protection_deg", GateOptions::kMaxProtection_deg, solve.ok_protection_deg);
      solve.v_max_mps = number(f, "v_max_mps", GateOptions::kVMax_mps, solve.v_max_mps);
      solve.w_max_dps = number(f, "w_max_dps", GateOptions::kWMax_degps, solve.w_max_dps);
      solve.prior_max_age_s =
          number(f, "prior_max_age_s", LocalizerOptions::kPriorMaxAge_s, solve.prior_max_age_s);
    });
  }

  void read_calibration(const toml::table* table) {
    in_block(table, [&](TomlFields& f) {
      config_.calibration.online = f.boolean("online", config_.calibration.online);
    });
  }

  void read_lcm(const toml::table* table) {
    in_block(table, [&](TomlFields& f) {
      LcmOptions& lcm = config_.lcm;
      lcm.url = f.text("url", lcm.url);
      lcm.channel_prefix = f.text("channel_prefix", lcm.channel_prefix);
      lcm.detections = f.boolean("detections", lcm.detections);
      lcm.key_file = file(f, "key_file", {});
      if (const auto url = parse_lcm_url(lcm.url); !url) {
        f.reject("url", "url: " + url.error().message);
      }
      if (!is_channel_prefix(lcm.channel_prefix)) {
        f.reject("channel_prefix",
                 fmt::format("channel_prefix must have 1 to {} characters, of ASCII without blanks",
                             kLongestChannelPrefix));
      }
    });
  }

  void read_record(const toml::table* table) {
    in_block(table, [&](TomlFields& f) {
      Config::Record& record = config_.record;
      record.dir = file(f, "dir", {});
      record.jpeg = f.choice("codec", {"pgm", "jpeg"}, 0) == 1;
      record.every_nth = integer(f, "every_nth", RecorderOptions::kEveryNth, record.every_nth);
      record.max_bytes = bytes(f, "max_bytes", Config::Record::kMaxBytes, record.max_bytes);
      record.keep_s = number(f, "keep_s", Config::Record::kKeep_s, record.keep_s);
      record.min_free_bytes =
          bytes(f, "min_free_bytes", Config::Record::kMinFreeBytes, record.min_free_bytes);
      record.markers = file(f, "markers", {});
    });
  }

  static std::uint64_t bytes(TomlFields& fields, std::string_view key, const Range& range,
                             std::uint64_t fallback) {
    return static_cast<std::uint64_t>(number(fields, key, range, static_cast<double>(fallback)));
  }

  void read_service(const toml::table* table) {
    in_block(table, [&](TomlFields& f) {
      Config::Service& service = config_.service;
      service.startup_wait_s =
          number(f, "startup_wait_s", Config::Service::kStartupWait_s, service.startup_wait_s);
      service.realtime = f.boolean("realtime", service.realtime);
      service.lock_memory = f.boolean("lock_memory", service.lock_memory);
    });
  }

  const toml::table& root_;
  std::string name_;
  fs::path folder_;
  Config config_;
  std::optional<Error> first_error_;
};

}  // namespace

Expected<Config> parse_config(std::string_view text, const fs::path& name) {
  const auto table = parse_toml(text, name.string(), ErrorKind::config);
  if (!table) return tl::make_unexpected(table.error());
  return ConfigReader(*table, name).read();
}

Expected<Config> read_config(const fs::path& path) {
  const auto table = read_toml(path, ErrorKind::config);
  if (!table) return tl::make_unexpected(table.error());
  return ConfigReader(*table, path).read();
}

std::optional<std::string> key_that_needs_restart(const Config& now, const Config& next) {
  if (now.map.empty() != next.map.empty()) return "[map]";
  if (now.rig.camchain != next.rig.camchain) return "[rig] camchain";
  const Rigid3& base = now.rig.base_from_rig;
  if (next.rig.base_from_rig.minus(base).norm() > 0) return "[rig] base_from_rig";
  if (now.cameras.size() != next.cameras.size()) return "[[camera]]";
  for (std::size_t i = 0; i < now.cameras.size(); ++i) {
    if (now.cameras[i] != next.cameras[i]) {
      return fmt::format("[[camera]] of {}", now.cameras[i].name);
    }
  }
  if (now.sync != next.sync) return "[sync]";
  if (now.lcm.url != next.lcm.url) return "[lcm] url";
  if (now.lcm != next.lcm) return "[lcm]";
  if (now.service != next.service) return "[service]";
  return std::nullopt;
}

}  // namespace waymark
