#include "core/camera/kalibr.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <string_view>

#include "core/base/atomic_file.h"
#include "core/base/notes.h"
#include "core/base/text_field.h"
#include "core/camera/foreign_calibration.h"
#include "core/camera/image_sizes.h"
#include "core/camera/kalibr_camera.h"
#include "core/camera/kalibr_sigmas.h"
#include "core/camera/yaml_text.h"

namespace waymark {
namespace {

/// How far T_cam_imu and the chain of T_cn_cnm1 may disagree.
constexpr double kMaxChainError_m = 1e-3;
constexpr double kMaxChainError_rad = 0.1 * std::numbers::pi / 180;

/// N of "camN" without leading zeros; nullopt for any other name.
std::optional<std::size_t> camera_number(std::string_view name) {
  if (!name.starts_with("cam")) return std::nullopt;
  const std::string_view digits = name.substr(3);
  if (digits.size() > 1 && digits[0] == '0') return std::nullopt;
  return parse_whole<std::size_t>(digits);
}

/// Sets each camera's rig_from_cam from T_cam_imu.
Status place_on_body(std::vector<KalibrCamera>& entries, const std::string& name) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    KalibrCamera& entry = entries[i];
    if (!entry.cam_from_body) {
      return fail(
          ErrorKind::bad_data,
          "{}: {}: T_cam_imu is missing, though other cameras have it; give it for all or none",
          name, entry.camera.name);
    }
    entry.camera.rig_from_cam = entry.cam_from_body->inverse();
    if (i == 0 || !entry.cam_from_previous) continue;
    const Rigid3 by_body = *entry.cam_from_body * entries[i - 1].cam_from_body->inverse();
    const double apart_m = (by_body.translation - entry.cam_from_previous->translation).norm();
    const double apart_rad = angle_between_rad(by_body.rotation, entry.cam_from_previous->rotation);
    if (apart_m > kMaxChainError_m || apart_rad > kMaxChainError_rad) {
      return fail(
          ErrorKind::bad_data,
          "{}: {}: T_cn_cnm1 and T_cam_imu disagree by {:.2f} mm and {:.3f}° (allowed: 1 mm, "
          "0.1°); they come from different calibrations",
          name, entry.camera.name, 1e3 * apart_m, apart_rad * 180 / std::numbers::pi);
    }
  }
  return {};
}

/// Sets each camera's rig_from_cam by following T_cn_cnm1 from cam0; false where there is no chain.
Expected<bool> place_on_chain(std::vector<KalibrCamera>& entries, const std::string& name) {
  const auto without = [](const KalibrCamera& entry) { return !entry.cam_from_previous; };
  if (entries.size() > 1 && std::all_of(entries.begin(), entries.end(), without)) return false;
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (!entries[i].cam_from_previous) {
      return fail(
          ErrorKind::bad_data,
          "{}: {}: T_cn_cnm1 is missing, though other cameras have it; give it for all or none",
          name, entries[i].camera.name);
    }
    entries[i].camera.rig_from_cam =
        entries[i - 1].camera.rig_from_cam * entries[i].cam_from_previous->inverse();
  }
  return true;
}

/// The cameras' nodes in order; other top-level keys become notes.
Expected<std::vector<YAML::Node>> camera_nodes(const YAML::Node& root, const std::string& name,
                                               std::vector<std::string>& notes) {
  if (!root.IsMap()) return fail(ErrorKind::bad_data, "{}: no camchain: cam0: … is missing", name);
  std::map<std::size_t, YAML::Node> by_number;
  for (const auto& item : root) {
    const auto key = item.first.as<std::string>();
    const int line = item.first.Mark().line + 1;
    const auto number = camera_number(key);
    if (!number) {
      if (key.starts_with("cam")) {
        return fail(ErrorKind::bad_data,
                    "{}: line {}: '{}' is no camera name; they are cam0, cam1, …", name, line, key);
      }
      notes.push_back(fmt::format("{}: line {}: unknown key '{}', not used", name, line, key));
      continue;
    }
    if (!by_number.emplace(*number, item.second).second) {
      return fail(ErrorKind::bad_data, "{}: line {}: {} stands there twice", name, line, key);
    }
  }
  if (by_number.empty()) {
    return fail(ErrorKind::bad_data, "{}: no camchain: cam0: … is missing", name);
  }
  std::vector<YAML::Node> nodes;
  for (const auto& [number, node] : by_number) {
    if (number != nodes.size()) {
      return fail(ErrorKind::bad_data,
                  "{}: line {}: cam{} without a cam{}; cameras are numbered from 0 without gaps",
                  name, node.Mark().line + 1, number, nodes.size());
    }
    nodes.push_back(node);
  }
  return nodes;
}

Expected<LoadedRig> load(const YAML::Node& given, const std::string& name) {
  LoadedRig loaded;
  const auto foreign = camchain_of_foreign(given, name);
  if (!foreign) return tl::make_unexpected(foreign.error());
  if (*foreign) {
    loaded.notes.push_back(caused_note(
        Cause::format, name + ": another program's calibration, read as a rig of one camera"));
  }
  const YAML::Node root = *foreign ? **foreign : given;
  const auto nodes = camera_nodes(root, name, loaded.notes);
  if (!nodes) return tl::make_unexpected(nodes.error());
  std::vector<KalibrCamera> entries;
  for (std::size_t i = 0; i < nodes->size(); ++i) {
    const std::string camera = fmt::format("cam{}", i);
    auto entry = read_kalibr_camera((*nodes)[i], camera, name, loaded.notes);
    if (!entry) return tl::make_unexpected(entry.error());
    entries.push_back(*std::move(entry));
  }
  if (entries.front().cam_from_previous) {
    return fail(ErrorKind::bad_data, "{}: cam0: T_cn_cnm1 has no meaning there; remove it", name);
  }
  if (std::any_of(entries.begin(), entries.end(),
                  [](const KalibrCamera& entry) { return entry.cam_from_body.has_value(); })) {
    const auto status = place_on_body(entries, name);
    if (!status) return tl::make_unexpected(status.error());
  } else {
    const auto chained = place_on_chain(entries, name);
    if (!chained) return tl::make_unexpected(chained.error());
    loaded.rig.has_extrinsics = *chained;
  }
  for (KalibrCamera& entry : entries) loaded.rig.cameras.push_back(std::move(entry.camera));
  if (auto taken = take_joint_sigmas(entries.front().sigma_joint, name, loaded.rig); !taken) {
    return tl::make_unexpected(taken.error());
  }
  if (auto sized = check_image_sizes(loaded.rig, name); !sized) {
    return tl::make_unexpected(sized.error());
  }
  return loaded;
}

}  // namespace

Expected<LoadedRig> read_camchain(const std::filesystem::path& path) {
  const auto text = read_file(path, kMaxCamchainBytes);
  if (!text) return tl::make_unexpected(text.error());
  return parse_camchain(*text, path.string());
}

Expected<LoadedRig> parse_camchain(const std::string& text, const std::string& name) {
  const auto root = parse_yaml(without_opencv_directive(text), name);
  if (!root) return tl::make_unexpected(root.error());
  try {
    return load(*root, name);
  } catch (const YAML::Exception& bad) {
    return fail(ErrorKind::bad_data, "{}: line {}: no camchain: {}", name, bad.mark.line + 1,
                bad.msg);
  }
}

}  // namespace waymark
