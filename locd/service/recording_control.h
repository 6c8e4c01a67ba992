#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "locd/publish/telemetry.h"
#include "locd/record/recorder.h"
#include "locd/service/control_socket.h"
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
};

/// Starts, stops and reports recordings on request (start, stop and status, a line each on the
/// control socket). No call waits: the answer to a request is ready once the recorder has carried
/// it out.
class RecordingControl {
 public:
  /// A disk that takes longer is said not to answer: a recording does not begin, or is left to end
  /// when it can.
  static constexpr Stamp kPatience = std::chrono::seconds(10);

  /// `plan`: how to record what begins now.
  RecordingControl(Recorder& recorder, std::function<RecordingPlan()> plan)
      : recorder_(recorder), plan_(std::move(plan)) {}

  /// Does what is requested. Answers: "ok FOLDER" when a recording has begun, or is on the disk;
  /// "ok …"; "error: …".
  [[nodiscard]] ControlSocket::Answer handle(std::string_view request, Stamp now);

  /// Before the service runs: has it record into `folder`, and waits until it does. Errors: those
  /// of RecordingFolder::open; io when the disk does not answer.
  [[nodiscard]] Status record_from_the_start(const std::filesystem::path& folder);

  /// What has begun, ended or can't be deleted since the last call.
  [[nodiscard]] std::vector<RecordingNews> take_news();

 private:
  [[nodiscard]] ControlSocket::Answer start(Stamp now);
  [[nodiscard]] ControlSocket::Answer stop(Stamp now);
  [[nodiscard]] std::string status() const;

  Recorder& recorder_;
  std::function<RecordingPlan()> plan_;
  std::uint64_t told_begun_ = 0;  ///< recordings of which it was told that they began
  bool told_end_ = true;          ///< of the last
  bool has_markers_ = false;      ///< the last one has a markers.toml
};

}  // namespace waymark
