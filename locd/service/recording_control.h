#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "locd/publish/telemetry.h"
#include "locd/record/recorder.h"
#include "locd/service/operator_requests.h"
#include "locd/service/setup.h"

namespace waymark {

/// What a recording says of itself, and how it is made.
struct RecordingPlan {
  RecordingFacts facts;
  RecorderOptions options;
};

/// How the configuration has frame sets recorded, in its archive: [record] dir, or where that is
/// not stated `default_archive`.
[[nodiscard]] RecordingPlan plan_recording(const Setup& setup, const Telemetry& telemetry,
                                           const std::filesystem::path& default_archive,
                                           const std::string& version);
[[nodiscard]] RecordingBudget recording_budget(const Config::Record& record);

/// What is to be told of a recording.
struct RecordingNews {
  std::string folder;  ///< of the recording
  std::string text;
  bool wrong = false;
  bool begun = false;  ///< a recording has begun
};

/// Starts, stops and marks recordings on request. No call waits: the answer to a request is ready
/// once the recorder has carried it out.
class RecordingControl {
 public:
  /// A disk that takes longer is said not to answer: a recording does not begin, or is left to end
  /// when it can.
  static constexpr Stamp kPatience = std::chrono::seconds(10);

  /// `plan`: how to record what begins now.
  /// `verdict`: what a recording that has ended is worth, in a line.
  RecordingControl(Recorder& recorder, std::function<RecordingPlan()> plan,
                   std::function<std::string()> verdict)
      : recorder_(recorder), plan_(std::move(plan)), verdict_(std::move(verdict)) {}

  /// A recording in a new folder, whose name ends in `name` where that is not empty. Answers with
  /// the folder once it has begun. Errors: usage (one runs; no name for a folder), kNoAnswer, those
  /// of RecordingFolder::open.
  [[nodiscard]] PendingReply start(std::string_view name, Stamp now);
  /// Answers with the folder, and what is in it worth, once all of it is on the disk. Errors: io.
  [[nodiscard]] PendingReply stop(Stamp now);
  /// Notes `text` in what is being recorded, at the date `utime`. Errors: unavailable when nothing
  /// is, or too many wait to be written.
  [[nodiscard]] PendingReply mark(std::string_view text, Stamp utime);

  /// "recording to FOLDER", "not recording", "starting", "stopping".
  [[nodiscard]] std::string status() const;

  /// Before the service runs: has it record into `folder`, and waits until it does. Errors: those
  /// of RecordingFolder::open; io when the disk does not answer.
  [[nodiscard]] Status record_from_the_start(const std::filesystem::path& folder);

  /// What has begun, ended or can't be deleted since the last call.
  [[nodiscard]] std::vector<RecordingNews> take_news();

 private:
  Recorder& recorder_;
  std::function<RecordingPlan()> plan_;
  std::function<std::string()> verdict_;
  std::uint64_t told_begun_ = 0;  ///< recordings of which it was told that they began
  bool told_end_ = true;          ///< of the last
  bool has_markers_ = false;      ///< the last one has a markers.toml
};

}  // namespace waymark
