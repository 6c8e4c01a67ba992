#pragma once

#include <functional>
#include <string>
#include <string_view>

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

/// How the configuration has frame sets recorded, in its archive.
[[nodiscard]] RecordingPlan plan_recording(const Setup& setup, const Telemetry& telemetry,
                                           const std::string& version);
[[nodiscard]] RecordingBudget recording_budget(const Config::Record& record);

/// Recordings as this machine's operators ask for them: start, stop and status, a line each on the
/// control socket. Waits for nothing: an answer is there once the recorder has done it.
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

 private:
  [[nodiscard]] ControlSocket::Answer start(Stamp now);
  [[nodiscard]] ControlSocket::Answer stop(Stamp now);
  [[nodiscard]] std::string status() const;

  Recorder& recorder_;
  std::function<RecordingPlan()> plan_;
};

}  // namespace waymark
