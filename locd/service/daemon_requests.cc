// What operators ask of a daemon on its control socket, and what they are told.
#include <cmath>
#include <utility>

#include "core/base/no_answer.h"
#include "core/camera/kalibr.h"
#include "core/map/json_value.h"
#include "core/marker/marker_catalog.h"
#include "locd/service/daemon_parts.h"

namespace waymark {
namespace {

/// A reload that takes longer goes on, but is not waited for.
constexpr Stamp kReloadPatience = std::chrono::seconds(10);

const char* name_of_state(std::int8_t state) {
  switch (state) {
    case camera_status_t::STREAMING:
      return "streaming";
    case camera_status_t::STALLED:
      return "stalled";
    case camera_status_t::LOST:
      return "lost";
    default:
      return "waiting";
  }
}

nlohmann::ordered_json json_of(const camera_status_t& camera) {
  return {{"name", camera.name},          {"state", name_of_state(camera.state)},
          {"usable", camera.usable != 0}, {"rate_hz", camera.rate_hz},
          {"frames", camera.frames},      {"dropped", camera.dropped},
          {"starts", camera.starts},      {"error", camera.error}};
}

/// JSON has no NaN: null says that it is not known.
nlohmann::ordered_json json_of(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

nlohmann::ordered_json json_of(const status_t& status) {
  nlohmann::ordered_json cameras = nlohmann::ordered_json::array();
  for (const camera_status_t& camera : status.cameras) cameras.push_back(json_of(camera));
  nlohmann::ordered_json drops = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < status.drop_reason.size(); ++i) {
    drops[status.drop_reason[i]] = status.drops[i];
  }
  return {{"status_text", status.text},
          {"version", status.version},
          {"utime", status.utime},
          {"uptime_s", status.uptime_s},
          {"map_hash", status.map_hash},
          {"map_markers", status.map_markers},
          {"quarantined_markers", status.quarantined_markers},
          {"set_rate_hz", status.set_rate_hz},
          {"sets", status.sets},
          {"poses",
           {{"OK", status.poses[0]},
            {"DEGRADED", status.poses[1]},
            {"AMBIGUOUS", status.poses[2]},
            {"LOST", status.poses[3]}}},
          {"latency_p50_ms", json_of(status.latency_p50_ms)},
          {"latency_max_ms", json_of(status.latency_max_ms)},
          {"time_error_s", status.time_error_s},
          {"publish_failures", status.publish_failures},
          {"recording", status.recording != 0},
          {"recording_path", status.recording_path},
          {"recorded_sets", status.recorded_sets},
          {"recorded_bytes", status.recorded_bytes},
          {"recorder_drops", status.recorder_drops},
          {"reload_refused", status.reload_refused},
          {"drops", drops},
          {"cameras", cameras}};
}

ControlAnswer about(const MarkerId& marker, std::string text) {
  return {std::move(text), {{"id", marker.number}, {"family", name_of(marker.family)}}};
}

}  // namespace

void Daemon::Parts::take_requests() {
  requests.add("status", "", [this](auto, Stamp) { return at_once(describe_status()); });
  requests.add("start", "[NAME]",
               [this](auto name, Stamp now) { return recordings.start(name, now); });
  requests.add("stop", "", [this](auto, Stamp now) { return recordings.stop(now); });
  requests.add("mark", "[TEXT]", [this](auto text, Stamp now) {
    return recordings.mark(text, std::chrono::microseconds(telemetry.utime_us(now)));
  });
  requests.add("reload", "", [this](auto, Stamp now) { return reload_on_request(now); });
  requests.add("release", "ID", [this](auto id, Stamp) { return at_once(release(id)); });
  requests.add("ignore", "ID", [this](auto id, Stamp now) { return at_once(ignore(id, now)); });
  requests.add("allow", "ID", [this](auto id, Stamp) { return at_once(allow(id)); });
  requests.add("calibration", "", [this](auto, Stamp) { return at_once(describe_calibration()); });
}

ControlAnswer Daemon::Parts::describe_status() const {
  status_t present = status;
  tell_present(present);
  ControlAnswer answer{recordings.status(), json_of(present)};
  const LocalizationCounts counts = localization.counts();
  for (std::size_t c = 0; c < answer.more["cameras"].size(); ++c) {
    answer.more["cameras"][c]["markers"] = counts.markers[c];
  }
  const MarkerTally tally = localization.tally();
  answer.more["markers_seen"] = tally.markers();
  if (present.recording != 0) answer.more["verdict"] = tally.verdict();
  nlohmann::ordered_json ignored = nlohmann::ordered_json::array();
  for (const MarkerId& marker : unused.ignored()) {
    ignored.push_back({{"id", marker.number}, {"family", name_of(marker.family)}});
  }
  answer.more["ignored"] = ignored;
  return answer;
}

ControlAnswer Daemon::Parts::describe_calibration() const {
  const std::string file = setup.config.rig.camchain.string();
  return {fmt::format("{} is in use as it was read: locd does not calibrate while it runs", file),
          {{"file", file}, {"online", false}, {"rig_yaml", format_camchain(setup.rig)}}};
}

PendingReply Daemon::Parts::reload_on_request(Stamp now) {
  begin_reload();
  return [this, before = reloads_ended,
          until = now + kReloadPatience](Stamp later) -> std::optional<ControlReply> {
    if (reloads_ended > before) {
      if (!last_reload) return tl::make_unexpected(last_reload.error());
      return ControlAnswer{"reloaded: " + options.config.string(), {{"map_hash", map->map_hash}}};
    }
    if (later < until) return std::nullopt;
    return fail(kNoAnswer, "{}: the files that it names are not read yet; the reload goes on",
                options.config.string());
  };
}

Expected<MarkerId> Daemon::Parts::marker_named(std::string_view text) const {
  if (setup.map) return parse_marker_id(text, setup.map->families().only());
  const auto catalog = parse_marker_catalog(setup.markers_toml, "markers.toml");
  return parse_marker_id(text, catalog ? catalog->only_family() : std::nullopt);
}

ControlReply Daemon::Parts::release(std::string_view text) {
  const auto marker = marker_named(text);
  if (!marker) return tl::make_unexpected(marker.error());
  if (!unused.is_quarantined(*marker)) {
    return fail(ErrorKind::bad_data, "marker {} is not in quarantine", text);
  }
  if (!localization.release(*marker)) {
    return fail(kNoAnswer, "no frame set has come since {} markers were released",
                Localizer::kMostOrders);
  }
  return about(*marker,
               fmt::format("marker {} is out of quarantine with the next frame set", text));
}

ControlReply Daemon::Parts::ignore(std::string_view text, Stamp now) {
  const auto marker = marker_named(text);
  if (!marker) return tl::make_unexpected(marker.error());
  if (auto taken = unused.ignore(*marker, telemetry.utime_us(now)); !taken) {
    return tl::make_unexpected(taken.error());
  }
  // What was said of it is over: nobody looks at it any more.
  if (unused.is_quarantined(*marker)) (void)localization.release(*marker);
  localization.ignore(unused.ignored());
  log.note(fmt::format("marker {} is ignored, as was requested", text));
  return about(*marker, fmt::format("marker {} is ignored from the next frame set on", text));
}

ControlReply Daemon::Parts::allow(std::string_view text) {
  const auto marker = marker_named(text);
  if (!marker) return tl::make_unexpected(marker.error());
  if (auto allowed = unused.allow(*marker); !allowed) return tl::make_unexpected(allowed.error());
  localization.ignore(unused.ignored());
  log.note(fmt::format("marker {} is ignored no more, as was requested", text));
  return about(*marker, fmt::format("marker {} is used from the next frame set on", text));
}

}  // namespace waymark
