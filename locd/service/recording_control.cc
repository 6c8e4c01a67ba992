#include "locd/service/recording_control.h"

#include "core/camera/kalibr.h"

namespace waymark {
namespace {

using Phase = Recorder::Phase;

ControlSocket::Answer at_once(std::string answer) {
  return [answer = std::move(answer)](Stamp /*now*/) { return answer; };
}

/// Empty when one can.
std::string why_none_can_start(const Recorder::State& state) {
  switch (state.phase) {
    case Phase::idle:
      return "";
    case Phase::starting:
      return "a recording is just starting";
    case Phase::recording:
      return "already recording to " + state.folder.string();
    case Phase::stopping:
      return "the recording before is not on the disk yet";
  }
  return "";
}

/// Whether the recording that was asked for has begun.
std::optional<std::string> how_it_began(const Recorder::State& state) {
  if (state.failure) return "error: " + state.failure->message;
  if (!state.folder.empty()) return "ok " + state.folder.string();
  if (state.phase == Phase::idle) return "error: it was stopped before it began";
  return std::nullopt;
}

/// Whether the recording that was to end is on the disk.
std::optional<std::string> how_it_ended(const Recorder::State& state) {
  if (state.phase != Phase::idle) return std::nullopt;
  if (state.failure) return "error: " + state.failure->message;
  return state.folder.empty() ? "ok there was no recording" : "ok " + state.folder.string();
}

}  // namespace

RecordingBudget recording_budget(const Config::Record& record) {
  RecordingBudget budget;
  budget.max_bytes = record.max_bytes;
  budget.keep = std::chrono::duration_cast<Stamp>(std::chrono::duration<double>(record.keep_s));
  budget.min_free_bytes = record.min_free_bytes;
  return budget;
}

RecordingPlan plan_recording(const Setup& setup, const Telemetry& telemetry,
                             const std::string& version) {
  const Config::Record& record = setup.config.record;
  RecordingPlan plan;
  plan.facts.rig_yaml = format_camchain(setup.rig);
  plan.facts.markers_toml = setup.markers_toml;
  plan.facts.session_id = telemetry.session().session_id;
  plan.facts.version = version;
  plan.facts.codec = record.jpeg ? "jpeg" : "pgm";
  plan.facts.sync_tolerance = sync_options(setup.config).tolerance;
  plan.facts.archive = record.dir;
  plan.options.jpeg = record.jpeg;
  plan.options.every_nth = record.every_nth;
  plan.options.budget = recording_budget(record);
  plan.options.name_offset = telemetry.utime_offset();
  for (const RigCamera& camera : setup.rig.cameras) {
    plan.facts.cameras.push_back(camera.name);
    const CameraParameters& size = camera.model.parameters();
    plan.options.pixels.push_back(static_cast<std::size_t>(size.width_px) *
                                  static_cast<std::size_t>(size.height_px));
  }
  return plan;
}

ControlSocket::Answer RecordingControl::handle(std::string_view request, Stamp now) {
  if (request == "start") return start(now);
  if (request == "stop") return stop(now);
  if (request == "status") return at_once(status());
  return at_once("error: the requests are start, stop and status");
}

std::string RecordingControl::status() const {
  const Recorder::State state = recorder_.state();
  switch (state.phase) {
    case Phase::idle:
      return "ok not recording";
    case Phase::starting:
      return "ok starting";
    case Phase::recording:
      return "ok recording to " + state.folder.string();
    case Phase::stopping:
      return "ok stopping";
  }
  return "";
}

ControlSocket::Answer RecordingControl::start(Stamp now) {
  if (const auto why = why_none_can_start(recorder_.state()); !why.empty()) {
    return at_once("error: " + why);
  }
  const RecordingPlan plan = plan_();
  recorder_.start({}, plan.facts, plan.options);
  return [this, archive = plan.facts.archive.string(), until = now + kPatience](Stamp later) {
    auto answer = how_it_began(recorder_.state());
    if (!answer && later >= until) {
      recorder_.stop();
      answer = "error: " + archive + ": the disk does not answer; the recording is given up";
    }
    return answer;
  };
}

ControlSocket::Answer RecordingControl::stop(Stamp now) {
  if (recorder_.state().phase == Phase::idle) return at_once("ok there was no recording");
  recorder_.stop();
  return [this, until = now + kPatience](Stamp later) {
    auto answer = how_it_ended(recorder_.state());
    if (!answer && later >= until) answer = "ok stopping";
    return answer;
  };
}

}  // namespace waymark
