#include "locd/service/replay_command.h"

#include <fmt/ostream.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "core/base/atomic_file.h"
#include "core/base/notes.h"
#include "core/base/output_check.h"
#include "core/capture/capture_files.h"
#include "core/geometry/tum.h"
#include "core/map/map_file.h"
#include "drivers/monotonic_clock.h"
#include "drivers/replay_source.h"
#include "locd/frames/rig_capture.h"
#include "locd/pose/localizer.h"
#include "locd/pose/map_index.h"
#include "locd/pose/pose_table.h"
#include "locd/service/map_rig_notes.h"

namespace waymark {
namespace {

/// Reasons that say nothing against the pose being right within its covariance.
constexpr ReasonBits kHarmless = bit(PoseReason::sigma) | bit(PoseReason::protection) |
                                 bit(PoseReason::camera_missing) | bit(PoseReason::no_velocity) |
                                 bit(PoseReason::skew) | bit(PoseReason::unsynced);

/// What becomes of the poses.
class ReplayOutput {
 public:
  ReplayOutput(const ReplayCommandOptions& options, const ReplayCapture& capture,
               const MarkerMap& map, std::ostream& notes)
      : options_(options),
        capture_(capture),
        several_families_(map.several_families()),
        notes_(notes) {
    if (options.table) table_ = pose_table_head();
  }

  void take(const PoseEstimate& estimate, std::span<const Alert> alerts) {
    ++by_status_.at(static_cast<std::size_t>(estimate.status));
    for (std::size_t r = 0; r < kPoseReasons; ++r) {
      by_reason_[r] += (estimate.reasons >> r) & 1U;
    }
    if (options_.table) append_pose_table_row(estimate, capture_.shift(), table_);
    if (options_.trajectory && estimate.has_pose() && estimate.status != PoseStatus::ambiguous &&
        (estimate.reasons & ~kHarmless) == 0) {
      trajectory_.push_back({format_stamp_s(estimate.set_stamp - capture_.shift()),
                             estimate.world_from_rig_at(estimate.set_stamp)});
    }
    for (const Alert& alert : alerts) {
      fmt::print(notes_, "set {}: {}\n", estimate.sequence,
                 alert_text(alert, capture_.folder().rig, several_families_));
    }
  }

  [[nodiscard]] Status finish(const DropCounts& dropped, std::ostream& out) const {
    const ReplayCapture::Unusable unusable = capture_.unusable();
    const std::size_t sets = by_status_[0] + by_status_[1] + by_status_[2] + by_status_[3];
    if (unusable.images > 0 && sets == 0) {
      return fail(ErrorKind::bad_data, "{}: no image of {} can be used; the first: {}",
                  capture_.folder().path.string(), unusable.images, unusable.first_reason);
    }
    if (options_.trajectory) {
      const auto written = write_file_atomically(*options_.trajectory, format_tum(trajectory_));
      if (!written) return written;
    }
    if (options_.table) {
      if (auto written = write_file_atomically(*options_.table, table_); !written) return written;
    }
    if (unusable.images > 0) {
      fmt::print(notes_, "note: {} images left out; the first: {}\n", unusable.images,
                 unusable.first_reason);
    }
    if (const std::string why = drops_by_reason(dropped); !why.empty()) {
      fmt::print(notes_,
                 "note: frames that came into no pose: {} (docs/operations.md tells them)\n", why);
    }
    fmt::print(out, "{} frame sets: {} OK, {} DEGRADED, {} AMBIGUOUS, {} LOST\n", sets,
               by_status_[0], by_status_[1], by_status_[2], by_status_[3]);
    if (const std::string reasons = reasons_by_count(); !reasons.empty()) {
      fmt::print(out,
                 "not OK because of {} (a set may have several; docs/operations.md tells them)\n",
                 reasons);
    }
    return {};
  }

 private:
  /// "late 3, overtaken 1"; empty where none was dropped.
  static std::string drops_by_reason(const DropCounts& dropped) {
    std::vector<std::string> parts;
    for (std::size_t r = 0; r < dropped.size(); ++r) {
      if (dropped[r] == 0) continue;
      parts.push_back(fmt::format("{} {}", name_of(static_cast<DropReason>(r)), dropped[r]));
    }
    return fmt::format("{}", fmt::join(parts, ", "));
  }

  /// "SIGMA 12, CAMERA_MISSING 3"; empty when every set was OK.
  [[nodiscard]] std::string reasons_by_count() const {
    std::vector<std::size_t> order;
    for (std::size_t r = 0; r < kPoseReasons; ++r) {
      if (by_reason_[r] > 0) order.push_back(r);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return by_reason_[a] > by_reason_[b]; });
    std::vector<std::string> parts;
    for (const std::size_t r : order) {
      parts.push_back(
          fmt::format("{} {}", name_of(static_cast<PoseReason>(1U << r)), by_reason_[r]));
    }
    return fmt::format("{}", fmt::join(parts, ", "));
  }

  const ReplayCommandOptions& options_;
  const ReplayCapture& capture_;
  bool several_families_;
  std::ostream& notes_;
  std::vector<TumPose> trajectory_;
  std::string table_;
  std::array<std::size_t, 4> by_status_{};
  std::array<std::size_t, kPoseReasons> by_reason_{};
};

SyncOptions sync_options(const CaptureFolder& folder) {
  SyncOptions options;
  options.tolerance = folder.sync_tolerance;
  return options;
}

using TakeSet = std::function<void(FrameSetLease&)>;

void add(const DropCounts& more, DropCounts& sum) {
  for (std::size_t r = 0; r < sum.size(); ++r) sum[r] += more[r];
}

/// Every set, in the order of stamps, which are the only clock. Gives what was dropped.
DropCounts play_all(const std::shared_ptr<ReplayCapture>& capture, const std::atomic<bool>& stop,
                    const TakeSet& take_set) {
  auto sources = ReplayCapture::sources(capture);
  SyncOptions options = sync_options(capture->folder());
  options.deadline = std::max(options.deadline, options.tolerance + Stamp(1));
  options.leave_after_sets = 0;
  FrameSynchronizer synchronizer(sources.size(), options);
  std::vector<std::optional<Frame>> next(sources.size());
  const auto fetch = [&](std::size_t c) {
    next[c].reset();
    // A replay that is not in real time neither waits nor fails.
    if (auto frame = sources[c]->next(Stamp::max()); frame && *frame) next[c] = std::move(**frame);
  };
  const auto take_ready = [&](Stamp now) {
    while (auto set = synchronizer.take(now)) take_set(*set);
  };
  for (std::size_t c = 0; c < sources.size(); ++c) {
    if (sources[c]->start()) fetch(c);
  }
  while (!stop) {
    std::optional<std::size_t> earliest;
    for (std::size_t c = 0; c < next.size(); ++c) {
      if (next[c] && (!earliest || next[c]->stamp() < next[*earliest]->stamp())) earliest = c;
    }
    if (!earliest) break;
    const Stamp now = next[*earliest]->stamp();
    // What comes now or later no longer belongs to the frames that are held.
    const auto due = synchronizer.next_deadline();
    if (due && now > *due - options.deadline + options.tolerance) take_ready(Stamp::max());
    synchronizer.push(*earliest, std::move(*next[*earliest]), now);
    fetch(*earliest);
    take_ready(now);
  }
  if (!stop) take_ready(Stamp::max());
  DropCounts dropped{};
  for (std::size_t c = 0; c < sources.size(); ++c) add(synchronizer.dropped(c), dropped);
  return dropped;
}

/// At the capture's own pace: what comes too late for the solver is dropped, as from cameras.
DropCounts play_in_real_time(const std::shared_ptr<ReplayCapture>& capture,
                             const std::atomic<bool>& stop, const TakeSet& take_set) {
  constexpr Stamp kLookAtStop = std::chrono::milliseconds(100);
  RigCapture rig(ReplayCapture::sources(capture), sync_options(capture->folder()));
  rig.start();
  while (!stop && !rig.ended()) {
    if (auto set = rig.wait(monotonic_now() + kLookAtStop)) take_set(*set);
  }
  rig.stop();
  DropCounts dropped{};
  for (std::size_t c = 0; c < capture->folder().rig.cameras.size(); ++c) {
    add(rig.state(c).dropped, dropped);
  }
  return dropped;
}

Status check_rig(const CaptureFolder& folder) {
  const std::size_t cameras = folder.rig.cameras.size();
  if (cameras > kMaxCameras) {
    return fail(ErrorKind::bad_data, "{}: {} cameras; locd takes at most {}", folder.path.string(),
                cameras, kMaxCameras);
  }
  if (cameras > 1 && !folder.rig.has_extrinsics) {
    return fail(ErrorKind::bad_data,
                "{}: {} cameras without transforms between them; add T_cn_cnm1 to rig.yaml",
                folder.path.string(), cameras);
  }
  return {};
}

/// What `locd --check` would say of map and rig.
void tell_of_map(const MarkerMap& map, const std::filesystem::path& map_path,
                 const CaptureFolder& folder, std::ostream& notes) {
  const auto told = map_rig_notes(map, map_path, folder.rig, folder.path / "rig.yaml");
  for (const std::string& line : shown_notes(told.warnings)) {
    fmt::print(notes, "warning: {}\n", line);
  }
  for (const std::string& line : shown_notes(told.notes)) {
    fmt::print(notes, "{}\n", note_line(line));
  }
}

/// Says before the work what could not be written after it.
Status check_outputs(const ReplayCommandOptions& options) {
  std::vector<std::filesystem::path> outputs;
  for (const auto& output : {options.trajectory, options.table}) {
    if (output) outputs.push_back(*output);
  }
  for (const std::filesystem::path& output : outputs) {
    if (auto writable = check_writable(output); !writable) return writable;
    if (auto spares = check_spares(output, {options.map}); !spares) return spares;
    if (auto spares = check_spares_captures(output, {options.capture}); !spares) return spares;
  }
  return check_differ(outputs, "trajectory and table");
}

}  // namespace

Status run_replay(const ReplayCommandOptions& options, const std::atomic<bool>& stop,
                  std::ostream& out, std::ostream& notes) {
  if (auto allowed = check_outputs(options); !allowed) return allowed;
  const auto map = read_map_file(options.map);
  if (!map) return tl::make_unexpected(map.error());
  ReplayOptions replay;
  replay.realtime = options.realtime;
  replay.loop = options.loop;
  replay.detections = !options.redetect;
  auto capture = ReplayCapture::open(options.capture, replay);
  if (!capture) return tl::make_unexpected(capture.error());
  const CaptureFolder& folder = (*capture)->folder();
  if (auto checked = check_rig(folder); !checked) return checked;
  for (const std::string& note : shown_notes(folder.notes)) {
    fmt::print(notes, "{}\n", note_line(note));
  }
  tell_of_map(*map, options.map, folder, notes);

  LocalizerOptions localizing;
  localizing.inverted = inverted_families(folder.catalog);
  Localizer localizer(folder.rig, *map, localizing);
  PoseEstimate estimate;
  ReplayOutput output(options, **capture, *map, notes);
  const TakeSet take_set = [&](FrameSetLease& set) {
    localizer.localize(set, estimate);
    output.take(estimate, localizer.alerts());
  };
  const DropCounts dropped =
      (options.realtime ? play_in_real_time : play_all)(*capture, stop, take_set);
  return output.finish(dropped, out);
}

}  // namespace waymark
