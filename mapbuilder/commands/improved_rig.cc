#include "mapbuilder/commands/improved_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "core/base/atomic_file.h"
#include "core/base/fingerprint.h"
#include "core/base/input_file.h"
#include "core/camera/kalibr.h"
#include "core/camera/rig_parameters.h"
#include "mapbuilder/build/output_paths.h"
#include "mapbuilder/commands/print_line.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

fs::path beside_map(const BuildCommandOptions& options) {
  return fs::path(options.output).replace_extension(".yaml");
}

/// What the rig files of builds begin with; what follows in the line is the rest's fingerprint.
constexpr std::string_view kOwnLine = "# mapbuilder build wrote this rig: ";

std::string own_line(std::string_view rest) {
  Fingerprint hash;
  hash.add(rest);
  return fmt::format("{}{}\n", kOwnLine, hash.hexadecimal());
}

/// Whether a build wrote the file, and nobody changed it since.
bool is_of_a_build(const fs::path& path) {
  auto file = InputFile::open(path, kMaxCamchainBytes);
  if (!file) return false;
  std::string text(file->size(), '\0');
  const auto size = file->read(text);
  if (!size || *size != text.size()) return false;
  const auto line = std::min(text.find('\n'), text.size() - 1) + 1;
  return text.substr(0, line) == own_line(text.substr(line));
}

/// Whether a rig that nobody asked for may go there: nothing is there, or an earlier build's rig
/// that nothing is read from.
bool may_take_place(const fs::path& path, const BuildCommandOptions& options) {
  std::error_code unknown;
  if (fs::symlink_status(path, unknown).type() == fs::file_type::not_found) return true;
  if (!check_spares_input(path, options.input, {options.survey, options.quarantine})) return false;
  return is_of_a_build(path);
}

}  // namespace

std::optional<fs::path> asked_rig_path(const BuildCommandOptions& options) {
  const VariableCalibration& refine = options.build.refine;
  if (options.refined_rig || (!refine.extrinsics && !refine.intrinsics)) return options.refined_rig;
  return beside_map(options);
}

Rig improved_rig(RigIndex rig, const Calibration& calibration, const Observations& observations) {
  Rig improved = calibration.rigs[rig];
  drop_unfit_joint_sigmas(improved);
  const std::size_t first = observations.first_camera[rig].value();
  for (std::size_t c = 0; c < improved.cameras.size(); ++c) {
    const auto& edges = observations.edges[CameraIndex(first + c)];
    if (!edges) continue;
    RigCamera& camera = improved.cameras[c];
    camera.edge_bias_px = edges->bias_px;
    state_sigma(c, CameraQuantity::edge, edges->sigma_px, improved);
    if (!camera.response) camera.response = edges->response;
  }
  return improved;
}

Status write_improved_rigs(const BuildCommandOptions& options, const BuildResult& result,
                           const Observations& observations, std::ostream& out,
                           std::ostream& notes) {
  const bool refined = result.calibration.refined;
  const auto& edges = observations.edges.values();
  const bool measured =
      std::any_of(edges.begin(), edges.end(), [](const auto& one) { return one.has_value(); });
  if (!refined && !measured) return {};
  const auto asked = asked_rig_path(options);
  const Calibration& calibration = result.estimate.calibration;
  for (const RigIndex rig : calibration.rigs.indices()) {
    const fs::path path = path_of_submap(asked.value_or(beside_map(options)), rig.value());
    if (!asked && !may_take_place(path, options)) {
      print_line(notes,
                 "note: {}: is there and no rig of an earlier build; the rig with its measured "
                 "edges, which locd needs with this map, was not written: name it with "
                 "--refined-rig",
                 path.string());
      return {};
    }
    const std::string text = format_camchain(improved_rig(rig, calibration, observations));
    if (auto written = write_file_atomically(path, own_line(text) + text); !written) return written;
    print_line(out, "{}: {}", path.string(),
               refined ? "refined rig" : "rig with its measured edges, for locd");
  }
  return {};
}

}  // namespace waymark
