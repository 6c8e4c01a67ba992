#include "locd/service/recording_control.h"

#include <algorithm>
#include <utility>

#include "core/base/no_answer.h"
#include "core/camera/kalibr.h"
#include "drivers/monotonic_clock.h"

namespace waymark {
namespace {

using Phase = Recorder::Phase;

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

/// The answer that names a recording's folder.
ControlAnswer in_folder(const std::filesystem::path& folder) {
  return {folder.string(), {{"folder", folder.string()}}};
}

/// Whether the recording that was asked for has begun.
std::optional<ControlReply> how_it_began(const Recorder::State& state) {
  if (state.failure) return tl::make_unexpected(*state.failure);
  if (!state.folder.empty()) return in_folder(state.folder);
  if (state.phase == Phase::idle)
    return fail(ErrorKind::unavailable, "it was stopped before it began");
  return std::nullopt;
}

/// Whether the recording that was to end is on the disk.
std::optional<ControlReply> how_it_ended(const Recorder::State& state) {
  if (state.phase != Phase::idle) return std::nullopt;
  if (state.failure) return tl::make_unexpected(*state.failure);
  return state.folder.empty() ? ControlAnswer{"there was no recording", {}}
                              : in_folder(state.folder);
}

/// Whether it can stand in a folder's name.
bool is_name(std::string_view text) {
  constexpr std::size_t kMost = 64;
  return text.size() <= kMost && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '-' || c == '_' || c == '.';
         });
}

bool is_same_folder(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code absent;
  return a == b || std::filesystem::equivalent(a, b, absent);
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
                             const std::filesystem::path& default_archive,
                             const std::string& version) {
  const Config::Record& record = setup.config.record;
  RecordingPlan plan;
  plan.facts.rig_yaml = format_camchain(setup.rig);
  plan.facts.markers_toml = setup.markers_toml;
  plan.facts.session_id = telemetry.session().session_id;
  plan.facts.version = version;
  plan.facts.codec = record.jpeg ? "jpeg" : "pgm";
  plan.facts.sync_tolerance = sync_options(setup.config).tolerance;
  plan.facts.archive = record.dir.empty() ? default_archive : record.dir;
  plan.facts.date_known = telemetry.date_known();
  plan.options.jpeg = record.jpeg;
  plan.options.every_nth = record.every_nth;
  plan.options.budget = recording_budget(record);
  for (const RigCamera& camera : setup.rig.cameras) {
    plan.facts.cameras.push_back(camera.name);
    const CameraParameters& size = camera.model.parameters();
    plan.options.pixels.push_back(static_cast<std::size_t>(size.width_px) *
                                  static_cast<std::size_t>(size.height_px));
  }
  return plan;
}

std::string RecordingControl::status() const {
  const Recorder::State state = recorder_.state();
  switch (state.phase) {
    case Phase::idle:
      return "not recording";
    case Phase::starting:
      return "starting";
    case Phase::recording:
      return "recording to " + state.folder.string();
    case Phase::stopping:
      return "stopping";
  }
  return "";
}

PendingReply RecordingControl::start(std::string_view name, Stamp now) {
  if (!is_name(name)) {
    return at_once(
        fail(ErrorKind::usage,
             "{}: no name for a recording: letters, digits, '-', '_' and '.', at most 64", name));
  }
  if (const auto why = why_none_can_start(recorder_.state()); !why.empty()) {
    return at_once(fail(ErrorKind::usage, "{}", why));
  }
  RecordingPlan plan = plan_();
  plan.facts.name = name;
  has_markers_ = !plan.facts.markers_toml.empty();
  recorder_.start({}, plan.facts, plan.options);
  return [this, archive = plan.facts.archive.string(), until = now + kPatience](Stamp later) {
    auto reply = how_it_began(recorder_.state());
    if (!reply && later >= until) {
      recorder_.stop();
      reply = fail(kNoAnswer, "{}: the disk does not answer; the recording is given up", archive);
    }
    return reply;
  };
}

PendingReply RecordingControl::stop(Stamp now) {
  if (recorder_.state().phase == Phase::idle) {
    return at_once(ControlAnswer{"there was no recording", {}});
  }
  recorder_.stop();
  return [this, until = now + kPatience](Stamp later) {
    auto reply = how_it_ended(recorder_.state());
    if (reply && *reply && (*reply)->more.contains("folder"))
      (*reply)->more["verdict"] = verdict_();
    if (!reply && later >= until) reply = ControlAnswer{"stopping", {}};
    return reply;
  };
}

PendingReply RecordingControl::mark(std::string_view text, Stamp utime) {
  const Recorder::State state = recorder_.state();
  if (!recorder_.mark(utime, in_one_line(text))) {
    return at_once(fail(ErrorKind::unavailable, "{}",
                        state.phase == Phase::recording
                            ? "the disk has not taken the marks before this one yet"
                            : "nothing is being recorded that could be marked; start first"));
  }
  ControlAnswer answer = in_folder(state.folder);
  answer.more["t_ns"] = utime.count();
  answer.text = fmt::format("marked {} in {}", utime.count(), answer.text);
  return at_once(std::move(answer));
}

Status RecordingControl::record_from_the_start(const std::filesystem::path& folder) {
  RecordingPlan plan = plan_();
  has_markers_ = !plan.facts.markers_toml.empty();
  if (!is_same_folder(folder.parent_path(), plan.facts.archive)) plan.facts.archive.clear();
  recorder_.start(folder, plan.facts, plan.options);
  if (!recorder_.settle(monotonic_now() + kPatience)) {
    return fail(ErrorKind::io, "{}: can't record here: the disk does not answer", folder.string());
  }
  const auto failure = recorder_.state().failure;
  return failure ? tl::make_unexpected(*failure) : Status{};
}

std::vector<RecordingNews> RecordingControl::take_news() {
  std::vector<RecordingNews> news;
  const Recorder::State state = recorder_.state();
  const std::string folder = state.folder.string();
  if (std::exchange(told_begun_, state.begun) != state.begun) {
    told_end_ = false;
    constexpr const char* kNoMarkers =
        " without markers.toml: mapbuilder reads it once one of the markers' families and sizes is "
        "copied there; set [record] markers to such a file for recordings to have it";
    news.push_back(
        {folder, "recording to " + folder + (has_markers_ ? "" : kNoMarkers), false, true});
  }
  for (const std::string& note : recorder_.take_notes()) news.push_back({folder, note, true});
  if (told_end_ || state.phase != Phase::idle) return news;
  told_end_ = true;
  const std::string how =
      state.failure ? state.failure->message : fmt::format("{}: {}", folder, verdict_());
  news.push_back({folder, "recording ended: " + how, state.failure.has_value()});
  return news;
}

}  // namespace waymark
