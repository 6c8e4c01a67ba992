#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/range.h"
#include "core/geometry/rigid3.h"
#include "locd/publish/lcm_options.h"

namespace waymark {

/// What brings a camera's frames.
enum class CameraDriver { v4l2, libcamera, replay };

/// locd.toml: one member per block, one field per key. Files are named relative to its folder.
struct Config {
  std::filesystem::path map;  ///< [map] path; empty: record only

  struct RigBlock {
    std::filesystem::path camchain;  ///< Kalibr camchain (rig.yaml)
    Rigid3 base_from_rig;            ///< the published pose is world_from_base
  } rig;

  /// [[camera]], one per camera of the rig, by name.
  struct Camera {
    std::string name;  ///< that of the camchain: cam0, …
    CameraDriver driver = CameraDriver::v4l2;
    std::string device;  ///< a link, "serial=…", "bus=…"; of replay, a capture folder, looped
    std::string format;  ///< empty: what the device offers
    double fps = 0;      ///< 1/s; 0: what the device does
    std::optional<double> exposure_us;
    std::optional<double> gain;
    std::optional<double> readout_us;  ///< µs, rolling shutter, first to last row; else rig.yaml's
    double stamp_delay_us = 0;         ///< µs, taken off every stamp of the camera
    std::optional<double> white_balance_k;  ///< K
    std::optional<double> focus;            ///< in the device's unit
    std::optional<int> power_line_hz;       ///< 0 (off), 50 or 60
    bool operator==(const Camera&) const = default;
  };
  std::vector<Camera> cameras;

  struct Sync {
    bool triggered = true;       ///< mode: the cameras expose together; else "free"
    double tolerance_us = 5000;  ///< µs, between the frames of one set
    double deadline_ms = 25;     ///< ms, from a set's first frame until it goes out incomplete
    int min_cameras = 1;         ///< fewer are no set
    bool operator==(const Sync&) const = default;
  } sync;

  struct Solve {
    double time_budget_ms = 200;   ///< ms, from exposure; a later set is dropped
    double ok_sigma_m = 0.02;      ///< m, OK needs 3 sigma of every axis within
    double ok_sigma_deg = 0.5;     ///< deg, the same for rotation
    double ok_protection_m = 0;    ///< m, OK needs the horizontal level within; 0: not asked for
    double ok_protection_deg = 0;  ///< deg, the same for rotation
    double v_max_mps = 3;          ///< m/s, faster is a JUMP
    double w_max_dps = 120;        ///< deg/s
    double prior_max_age_s = 0.5;  ///< s, an older pose predicts nothing

    static constexpr Range kTimeBudget_ms{1, 60'000};
    bool operator==(const Solve&) const = default;
  } solve;

  struct Calibration {
    bool online =
        true;  ///< what it errs by within what is stated is learnt while the vehicle drives
    bool operator==(const Calibration&) const = default;
  } calibration;

  LcmOptions lcm;

  struct Record {
    std::filesystem::path dir;  ///< empty: recordings in the state folder
    bool jpeg = false;          ///< codec = "jpeg", else "pgm"
    int every_nth = 1;          ///< one of so many frame sets
    std::uint64_t max_bytes = 10'000'000'000;
    double keep_s = 7 * 86400.0;                   ///< s, older sets are deleted
    std::uint64_t min_free_bytes = 1'000'000'000;  ///< left free on the file system
    std::filesystem::path markers;  ///< markers.toml for recordings; empty: made from the map

    static constexpr Range kMaxBytes{1e6, 1e15};
    static constexpr Range kKeep_s{1, 1e9};
    static constexpr Range kMinFreeBytes{0, 1e15};
    bool operator==(const Record&) const = default;
  } record;

  struct Service {
    double startup_wait_s = 10;  ///< s, READY without a camera that does not stream by then
    bool realtime = false;       ///< capture and solve threads on SCHED_FIFO
    bool lock_memory = false;    ///< mlockall

    static constexpr Range kStartupWait_s{0, 3600};
    bool operator==(const Service&) const = default;
  } service;
};

/// Reads locd.toml. Errors: config with file, line and key for an unknown key, a value of another
/// kind or outside its range, a missing block, a camera named twice; no_input when absent.
[[nodiscard]] Expected<Config> read_config(const std::filesystem::path& path);
/// The same from text; `name` stands for the path in messages, and its folder for the files' one.
[[nodiscard]] Expected<Config> parse_config(std::string_view text,
                                            const std::filesystem::path& name);

/// The first key whose change only a restart can bring about ("[lcm] url"); nullopt when `next` can
/// take the place of `now` while locd runs: map, solve and record are free to change.
[[nodiscard]] std::optional<std::string> key_that_needs_restart(const Config& now,
                                                                const Config& next);

}  // namespace waymark
