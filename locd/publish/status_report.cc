#include "locd/publish/status_report.h"

#include <algorithm>

namespace waymark {
namespace {

/// A camera that delivered so recently is there, however fast it is otherwise.
constexpr Stamp kAlive = std::chrono::seconds(1);
/// Cameras are not slower than this.
constexpr Stamp kSlowest = std::chrono::seconds(10);

double rate_hz(std::uint64_t count, Stamp interval) {
  const double seconds = in_s(interval);
  return seconds > 0 ? static_cast<double>(count) / seconds : 0;
}

std::int8_t state_of(const RigCapture::CameraState& camera, bool running) {
  if (running) return camera_status_t::STREAMING;
  if (!camera.error.empty()) return camera_status_t::LOST;
  return camera.frames == 0 ? camera_status_t::WAITING : camera_status_t::STALLED;
}

}  // namespace

StatusReport::StatusReport(const Rig& rig) {
  for (const RigCamera& camera : rig.cameras) cameras_.emplace_back().name = camera.name;
}

void StatusReport::judge(const std::vector<RigCapture::CameraState>& states, Stamp now) {
  for (std::size_t c = 0; c < states.size(); ++c) {
    const RigCapture::CameraState& state = states[c];
    Memory& memory = cameras_[c];
    const std::uint64_t came = state.frames - memory.frames_judged;
    if (came > 0) {
      const Stamp period = (state.last_frame - memory.last_frame) / static_cast<Stamp::rep>(came);
      // A longer pause is a camera that was away.
      if (memory.frames_judged > 0 && period < kSlowest) memory.period = period;
      memory.frames_judged = state.frames;
      memory.last_frame = state.last_frame;
    }
    memory.running =
        state.frames > 0 && now - state.last_frame < std::max(kAlive, 3 * memory.period);
  }
}

bool StatusReport::all_run() const {
  return std::all_of(cameras_.begin(), cameras_.end(), [](const Memory& c) { return c.running; });
}

std::vector<Alert> StatusReport::camera_alerts(const std::vector<RigCapture::CameraState>& states,
                                               Stamp now, Stamp grace) {
  if (!first_look_) first_look_ = now;
  std::vector<Alert> alerts;
  for (std::size_t c = 0; c < states.size(); ++c) {
    const auto tell = [&](AlertKind kind, bool& told, bool holds) {
      if (told == holds) return;
      told = holds;
      Alert alert;
      alert.kind = kind;
      alert.raised = holds;
      alert.stamp = now;
      alert.camera = static_cast<int>(c);
      alerts.push_back(alert);
    };
    const bool may_still_come = states[c].frames == 0 && now - *first_look_ < grace;
    tell(AlertKind::camera_missing, cameras_[c].missing, !cameras_[c].running && !may_still_come);
    tell(AlertKind::stamps_unsynced, cameras_[c].unsynced, states[c].unsynced);
    tell(AlertKind::settings_changed, cameras_[c].settings, !states[c].changed_settings.empty());
  }
  return alerts;
}

std::vector<StatusReport::CameraNews> StatusReport::camera_news(
    const std::vector<RigCapture::CameraState>& states) {
  std::vector<CameraNews> news;
  for (std::size_t c = 0; c < states.size(); ++c) {
    const std::string& name = cameras_[c].name;
    const auto tell = [&](const char* what, std::string& told, const std::string& now) {
      if (told == now) return;
      told = now;
      if (!now.empty()) news.push_back({name + what, fmt::format("{}: {}", name, now)});
    };
    tell(" runs", cameras_[c].description, states[c].description);
    tell(" fails", cameras_[c].error, states[c].error);
    tell(" settings", cameras_[c].changed_settings, states[c].changed_settings);
  }
  return news;
}

std::optional<Error> StatusReport::misconfiguration(
    const std::vector<RigCapture::CameraState>& states) const {
  for (std::size_t c = 0; c < states.size(); ++c) {
    if (!states[c].misconfigured) continue;
    return Error{ErrorKind::config, fmt::format("{}: {}", cameras_[c].name, states[c].error)};
  }
  return std::nullopt;
}

void StatusReport::fill(const std::vector<RigCapture::CameraState>& states,
                        const LocalizationCounts& counts, Stamp interval, status_t& status) {
  DropCounts dropped{};
  std::uint64_t damaged = 0;
  std::uint64_t lost = 0;
  status.cameras.resize(states.size());
  status.camera_count = static_cast<std::int32_t>(states.size());
  for (std::size_t c = 0; c < states.size(); ++c) {
    const RigCapture::CameraState& state = states[c];
    camera_status_t& camera = status.cameras[c];
    std::uint64_t unused = state.damaged + state.lost;
    for (std::size_t r = 0; r < kDropReasons; ++r) {
      const std::uint64_t frames = state.dropped[r] + counts.left_out[c][r];
      unused += frames;
      dropped[r] += frames;
    }
    damaged += state.damaged;
    lost += state.lost;
    camera.name = cameras_[c].name;
    camera.state = state_of(state, cameras_[c].running);
    camera.usable = static_cast<std::int8_t>((counts.unhealthy & camera_bit(c)) == 0);
    camera.rate_hz = rate_hz(state.frames - cameras_[c].frames_filled, interval);
    camera.frames = static_cast<std::int64_t>(state.frames);
    camera.dropped = static_cast<std::int64_t>(unused);
    camera.starts = static_cast<std::int64_t>(state.starts);
    camera.error = state.error;
    cameras_[c].frames_filled = state.frames;
  }
  status.drop_reason.clear();
  status.drops.clear();
  const auto add = [&](const char* reason, std::uint64_t count) {
    status.drop_reason.emplace_back(reason);
    status.drops.push_back(static_cast<std::int64_t>(count));
  };
  for (std::size_t r = 0; r < kDropReasons; ++r) {
    add(name_of(static_cast<DropReason>(r)), dropped[r]);
  }
  add("damaged", damaged);
  add("lost", lost);
  add("over_budget", counts.late);
  add("overload", counts.skipped);
  add("alerts", counts.alerts_lost);
  status.drop_count = static_cast<std::int32_t>(status.drops.size());
  status.set_rate_hz = rate_hz(counts.sets - last_sets_, interval);
  status.sets = static_cast<std::int64_t>(counts.sets);
  status.set_divisor = counts.divisor;
  last_sets_ = counts.sets;
}

std::string StatusReport::text(const status_t& status, const std::string& poses) {
  std::string line = fmt::format("{}; {:.1f} frame sets/s", poses, status.set_rate_hz);
  if (status.set_divisor > 1) {
    line += fmt::format(", overloaded: one of {} localized", status.set_divisor);
  }
  if (status.map_hash.empty()) line += "; no map";
  if (status.recording != 0) line += fmt::format("; recording to {}", status.recording_path);
  for (const camera_status_t& camera : status.cameras) {
    if (camera.state == camera_status_t::STREAMING) continue;
    line += fmt::format("; {} missing{}{}", camera.name, camera.error.empty() ? "" : ": ",
                        camera.error);
  }
  if (!status.reload_refused.empty()) line += "; reload refused: " + status.reload_refused;
  return line;
}

}  // namespace waymark
