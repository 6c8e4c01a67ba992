#include "locd/control/locdctl_command.h"

#include <fmt/ostream.h>

#include <cmath>

#include "core/base/atomic_file.h"
#include "locd/control/control_client.h"

namespace waymark {
namespace {

using Json = nlohmann::ordered_json;

/// A member's text; empty where it has none.
std::string text_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? in_one_line(found->get<std::string>()) : "";
}

double number_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : 0;
}

/// Whether a member is there and is `value`.
bool is(const Json& object, const char* key, bool value) {
  const auto found = object.find(key);
  return found != object.end() && found->is_boolean() && found->get<bool>() == value;
}

std::string describe_camera(const Json& camera) {
  std::string line = fmt::format("{:<6} {:<10} {:5.1f}/s", text_of(camera, "name"),
                                 text_of(camera, "state"), number_of(camera, "rate_hz"));
  if (camera.is_object() && camera.contains("markers")) {
    const double markers = number_of(camera, "markers");
    line += markers > 0 ? fmt::format(", {:.0f} markers", markers) : ", sees no marker";
  }
  if (const double dropped = number_of(camera, "dropped"); dropped > 0) {
    line += fmt::format(", {:.0f} of {:.0f} frames not used", dropped, number_of(camera, "frames"));
  }
  if (is(camera, "usable", false)) line += ", its images can't be used";
  if (const std::string error = text_of(camera, "error"); !error.empty()) line += ": " + error;
  return line + "\n";
}

std::string describe_ignored(const Json& status) {
  std::string ids;
  if (!status.contains("ignored")) return ids;
  for (const Json& marker : status["ignored"]) {
    ids += fmt::format("{}{}:{:.0f}", ids.empty() ? "" : ", ", text_of(marker, "family"),
                       number_of(marker, "id"));
  }
  return ids.empty() ? "" : "ignored on request: " + ids + "\n";
}

Status deliver_calibration(const Json& answer, const LocdctlOptions& options, std::ostream& out,
                           std::ostream& notes) {
  fmt::print(notes, "note: {}\n", text_of(answer, "text"));
  const auto rig = answer.find("rig_yaml");
  if (rig == answer.end() || !rig->is_string()) {
    return fail(ErrorKind::bad_data, "{}: the answer holds no rig file", options.control.string());
  }
  const auto& text = rig->get_ref<const std::string&>();
  if (options.output) return write_file_atomically(*options.output, text);
  out << text;
  return {};
}

}  // namespace

std::string describe_status(const Json& status) {
  std::string text = text_of(status, "status_text");
  if (text.empty()) text = "just started";
  text += "\n";
  if (status.contains("cameras")) {
    for (const Json& camera : status["cameras"]) text += describe_camera(camera);
  }
  text += text_of(status, "text");
  if (is(status, "recording", true)) {
    text += fmt::format(": {:.0f} frame sets, {:.1f} MB", number_of(status, "recorded_sets"),
                        number_of(status, "recorded_bytes") / 1e6);
    if (const double drops = number_of(status, "recorder_drops"); drops > 0) {
      text += fmt::format(", {:.0f} that the disk did not take in time", drops);
    }
  }
  text += "\n";
  if (const std::string verdict = text_of(status, "verdict"); !verdict.empty()) {
    text += "until now: " + verdict + "\n";
  }
  if (const double markers = number_of(status, "quarantined_markers"); markers > 0) {
    text += fmt::format("in quarantine: {:.0f} of {:.0f} markers\n", markers,
                        number_of(status, "map_markers"));
  }
  return text + describe_ignored(status);
}

Status run_locdctl(const LocdctlOptions& options, std::ostream& out, std::ostream& notes) {
  std::string request = options.request;
  if (!options.argument.empty()) request += " " + options.argument;
  const auto patience = std::chrono::milliseconds(std::llround(options.timeout_s * 1e3));
  const auto answer = ask_locd(options.control, request, patience);
  if (!answer) return tl::make_unexpected(answer.error());
  if (options.request == "calibration" && (options.output || !options.json)) {
    return deliver_calibration(*answer, options, out, notes);
  }
  if (options.json) {
    out << answer->dump(1) << "\n";
  } else if (options.request == "status") {
    out << describe_status(*answer);
  } else {
    out << text_of(*answer, "text") << "\n";
    if (const std::string verdict = text_of(*answer, "verdict"); !verdict.empty()) {
      fmt::print(notes, "note: {}\n", verdict);
    }
  }
  return {};
}

}  // namespace waymark
