#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "bench/cause_variants/variant.h"
#include "bench/processor_time.h"
#include "core/base/check.h"
#include "core/camera/kalibr.h"
#include "core/capture/detections_csv_text.h"
#include "mapbuilder/commands/build_command.h"
#include "mapbuilder/commands/import_command.h"
#include "mapbuilder/commands/localize_command.h"

namespace waymark::bench {
namespace {

namespace fs = std::filesystem;

void write_text(const fs::path& path, std::string text,
                const std::function<void(std::string&)>& change = {}) {
  if (change) change(text);
  std::ofstream(path, std::ios::binary) << text;
}

void write_capture(const fs::path& folder, const World& world, const Variant* changes) {
  fs::create_directories(folder);
  std::vector<ImageDetections> images = seen_images(world);
  if (changes != nullptr) {
    for (const auto& change : changes->on_images) change(images);
  }
  std::sort(images.begin(), images.end(), [](const auto& a, const auto& b) {
    return std::pair(a.stamp, a.camera) < std::pair(b.stamp, b.camera);
  });
  using Change = std::function<void(std::string&)>;
  write_text(folder / "rig.yaml", format_camchain(world.stated_rig),
             changes != nullptr ? changes->on_rig : Change{});
  write_text(folder / "markers.toml", format_marker_catalog(world.stated_catalog),
             changes != nullptr ? changes->on_markers : Change{});
  // As written by somebody: a fingerprint would say that the stated markers are not those detected.
  std::string csv = format_detections_csv(images, world.rig, world.stated_catalog, "bench");
  csv.erase(0, csv.find('\n') + 1);
  write_text(folder / "detections.csv", std::move(csv),
             changes != nullptr ? changes->on_csv : Change{});
}

std::vector<fs::path> write_captures(const Variant& variant, const fs::path& folder) {
  std::vector<fs::path> paths;
  for (std::size_t i = 0; i < variant.worlds.size(); ++i) {
    paths.push_back(folder / fmt::format("capture{}", i));
    write_capture(paths.back(), variant.worlds[i], i == 0 ? &variant : nullptr);
  }
  return paths;
}

Status build(const Variant& variant, const fs::path& folder, std::vector<fs::path> captures,
             std::ostream& notes) {
  BuildCommandOptions options;
  options.input.paths = std::move(captures);
  options.input.detect.threads = 1;
  options.output = folder / "map";
  options.report = folder / "report";
  options.level = variant.level;
  if (!variant.survey_toml.empty()) {
    options.survey = folder / "survey.toml";
    write_text(*options.survey, variant.survey_toml);
  }
  Progress silent(false);
  std::ostringstream out;
  return run_build(options, silent, out, notes);
}

Status localize(const Variant& variant, const fs::path& folder, std::vector<fs::path> captures,
                std::ostream& notes) {
  write_text(folder / "hall.json", variant.hand_map_json);
  std::ostringstream out;
  ImportOptions import;
  import.input = folder / "hall.json";
  import.output = folder / "map";
  Progress silent(false);
  if (auto imported = run_import(import, silent, out, notes); !imported) return imported;
  LocalizeOptions options;
  options.input.paths = std::move(captures);
  options.input.detect.threads = 1;
  options.map = folder / "map";
  options.trajectory = folder / "trajectory.tum";
  return run_localize(options, silent, out, notes);
}

Severity severity_of(const std::string& name) {
  return name == "error" ? Severity::error : name == "warning" ? Severity::warning : Severity::note;
}

/// All that match in a text.
std::set<std::string> all_of(const std::string& text, const char* pattern) {
  std::set<std::string> found;
  const std::regex regex(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it) {
    found.insert(it->str());
  }
  return found;
}

/// Findings as a terminal shows them: one a cause.
std::vector<Said::Line> lines_of(const std::string& output) {
  static const std::regex kLine(R"(^(note|warning|error) \[([a-z_]+)\] ([^:]*): .*)");
  std::vector<Said::Line> lines;
  std::istringstream stream(output);
  for (std::string text; std::getline(stream, text);) {
    std::smatch match;
    if (!std::regex_match(text, match, kLine)) continue;
    const auto cause = cause_from_name(match[2].str());
    WAYMARK_CHECK(cause.has_value());
    Said::Line line;
    line.severity = severity_of(match[1]);
    line.cause = *cause;
    line.subject = match[3];
    line.cameras = all_of(line.subject, "cam[0-9]+");
    if (line.subject.rfind("marker", 0) == 0) line.markers = all_of(line.subject, "[0-9]+");
    lines.push_back(std::move(line));
  }
  return lines;
}

std::optional<double> number_in(const nlohmann::json& json, const char* key) {
  return json.at(key).is_number() ? std::optional(json.at(key).get<double>()) : std::nullopt;
}

/// All findings of a report.
std::vector<Said::Line> findings_in(const fs::path& summary_json) {
  std::ifstream file(summary_json);
  const auto summary = nlohmann::json::parse(file);
  std::vector<Said::Line> lines;
  for (const auto& json : summary.at("findings")) {
    Said::Line line;
    line.severity = severity_of(json.at("severity").get<std::string>());
    line.cause = cause_from_name(json.at("cause").get<std::string>()).value();
    line.subject = json.at("subject").get<std::string>();
    for (const auto& camera : json.at("cameras")) line.cameras.insert(camera.get<std::string>());
    for (const auto& marker : json.at("markers")) {
      line.markers.insert(marker.is_string() ? marker.get<std::string>() : marker.dump());
    }
    line.value = number_in(json, "value");
    line.sigma = number_in(json, "sigma");
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace

Said run_variant(const Variant& variant, const fs::path& folder) {
  fs::remove_all(folder);
  auto captures = write_captures(variant, folder);
  Said said;
  std::ostringstream notes;
  const double started_s = processor_s();
  const Status status = variant.hand_map_json.empty()
                            ? build(variant, folder, std::move(captures), notes)
                            : localize(variant, folder, std::move(captures), notes);
  said.cpu_s = processor_s() - started_s;
  if (!status) {
    said.exit_code = status.error().exit_code();
    notes << line_of(status.error(), "mapbuilder") << '\n';
  }
  said.output = notes.str();
  const fs::path summary = folder / "report" / "summary.json";
  if (fs::exists(summary)) said.findings = findings_in(summary);
  // What was said before or instead of a report.
  for (Said::Line& line : lines_of(said.output)) {
    const bool known = std::any_of(said.findings.begin(), said.findings.end(),
                                   [&](const auto& one) { return one.cause == line.cause; });
    if (!known) said.findings.push_back(std::move(line));
  }
  return said;
}

}  // namespace waymark::bench
