#include "drivers/v4l2/device_lookup.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "core/base/one_line.h"
#include "drivers/v4l2/capture_capability.h"

namespace waymark {
namespace {

constexpr std::string_view kForms =
    "name it by a link (/dev/v4l/by-id/…), \"serial=…\", \"bus=…\" or \"bus=… serial=…\"; "
    "locd --list-cameras prints them";

/// A bus that is not known yet is none of USB's.
bool may_be_at(const std::string& bus, const VideoDevice& device) {
  if (bus.empty()) return true;
  return device.bus.empty() ? !bus.starts_with("usb-") : bus == device.bus;
}

bool is_number(std::string_view path) {
  constexpr std::string_view kNumbered = "/dev/video";
  return path.starts_with(kNumbered) && std::all_of(path.begin() + kNumbered.size(), path.end(),
                                                    [](char c) { return c >= '0' && c <= '9'; });
}

bool fits(const DeviceIdentity& identity, const VideoDevice& device) {
  return device.permitted && may_be(identity, device) &&
         (identity.bus.empty() || identity.bus == device.bus);
}

std::string names_of(const std::vector<VideoDevice>& devices) {
  std::vector<std::string> names;
  std::transform(devices.begin(), devices.end(), std::back_inserter(names),
                 [](const VideoDevice& device) { return name_of(device); });
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Adds what only the opened device tells; false for what is no camera, such as a node of metadata.
bool describe_camera(VideoNode& node, VideoDevice& device) {
  const auto can = capture_capability(node);
  if (!can || !can->streams()) return false;
  if (device.bus.empty()) device.bus = can->bus;
  device.card = can->card;
  return true;
}

}  // namespace

std::string not_permitted(const std::string& node) {
  return node + ": not allowed; the user must be in group video (usermod -aG video USER)";
}

std::string name_of(const VideoDevice& device) {
  if (!device.permitted) return device.node;
  return in_one_line(fmt::format("{} ({}, {}{}{})", device.node, device.card, device.bus,
                                 device.serial.empty() ? "" : ", serial ", device.serial));
}

bool is_plain(std::string_view name) {
  return std::all_of(name.begin(), name.end(),
                     [](char c) { return c >= ' ' && c <= '~' && c != '\'' && c != '"'; });
}

std::vector<VideoDevice> find_cameras(VideoSystem& system, const DeviceIdentity& wanted) {
  std::vector<VideoDevice> cameras;
  for (VideoDevice& device : system.nodes()) {
    if (!may_be(wanted, device)) continue;
    const auto node = system.open(device.node);
    device.permitted = node || node.error().kind != ErrorKind::permission;
    if (device.permitted && (!node || !describe_camera(**node, device))) continue;
    cameras.push_back(std::move(device));
  }
  return cameras;
}

bool may_be(const DeviceIdentity& wanted, const VideoDevice& device) {
  if (wanted.path.empty()) {
    return (wanted.serial.empty() || wanted.serial == device.serial) &&
           may_be_at(wanted.bus, device);
  }
  if (std::find(device.links.begin(), device.links.end(), wanted.path) != device.links.end()) {
    return true;
  }
  std::error_code absent;  // links that others than udev made
  return std::filesystem::canonical(wanted.path, absent) == device.node && !absent;
}

std::string DeviceIdentity::text() const {
  if (!path.empty()) return path;
  const char* const between = !bus.empty() && !serial.empty() ? " " : "";
  return (bus.empty() ? "" : "bus=" + bus) + between + (serial.empty() ? "" : "serial=" + serial);
}

Expected<DeviceIdentity> parse_device_identity(std::string_view text) {
  DeviceIdentity identity;
  if (!is_plain(text)) {
    return fail(ErrorKind::config,
                "\"{}\" has letters outside ASCII, or quotes; name the camera by \"bus=…\"", text);
  }
  if (is_number(text)) {
    return fail(ErrorKind::config,
                "\"{}\" is a number, which changes when cameras are replugged; {}", text, kForms);
  }
  if (text.starts_with('/')) {
    identity.path = text;
    return identity;
  }
  for (std::string_view rest = text; !rest.empty();) {
    const auto blank = rest.find(' ');
    const std::string_view word = rest.substr(0, blank);
    rest = blank == std::string_view::npos ? "" : rest.substr(blank + 1);
    if (word.empty()) continue;
    const auto equals = word.find('=');
    const std::string_view key = word.substr(0, equals);
    std::string* const part = key == "serial" ? &identity.serial
                              : key == "bus"  ? &identity.bus
                                              : nullptr;
    if (part == nullptr || equals == std::string_view::npos || equals + 1 == word.size()) {
      return fail(ErrorKind::config, "\"{}\" names no camera; {}", text, kForms);
    }
    *part = word.substr(equals + 1);
  }
  if (identity.serial.empty() && identity.bus.empty()) {
    return fail(ErrorKind::config, "\"{}\" names no camera; {}", text, kForms);
  }
  return identity;
}

Expected<VideoDevice> find_device(const DeviceIdentity& identity,
                                  const std::vector<VideoDevice>& devices) {
  std::vector<VideoDevice> fitting;
  std::copy_if(devices.begin(), devices.end(), std::back_inserter(fitting),
               [&](const VideoDevice& device) { return fits(identity, device); });
  if (fitting.size() == 1) return fitting.front();
  if (fitting.empty()) {
    // Also at boot, before udev has given the nodes to their group.
    const auto forbidden = std::find_if(devices.begin(), devices.end(), [&](const auto& device) {
      return !device.permitted && may_be(identity, device);
    });
    if (forbidden != devices.end()) {
      return fail(ErrorKind::permission, "{}: {}", identity.text(), not_permitted(forbidden->node));
    }
    return fail(ErrorKind::unavailable,
                "{}: no such camera is plugged in; locd --list-cameras names those that are",
                identity.text());
  }
  // Which of them was meant, another configuration tells, but also unplugging one: a twin that
  // comes makes a missing camera, no wrong configuration.
  return fail(ErrorKind::unavailable,
              "{}: {} can't be told apart by it; unplug all but one, or use bus=… or a link below "
              "/dev/v4l/by-path",
              identity.text(), names_of(fitting));
}

Status check_serial(const VideoDevice& device, const CameraOptions& options) {
  if (options.serial.empty() || device.serial == options.serial) return {};
  return fail(
      ErrorKind::config,
      "{}: has serial number \"{}\", rig.yaml's {} has \"{}\": another camera needs another "
      "calibration",
      device.node, device.serial, options.name, options.serial);
}

std::string identity_among(const VideoDevice& device, const std::vector<VideoDevice>& devices) {
  std::vector<DeviceIdentity> candidates;
  if (!device.serial.empty()) candidates.push_back({"", device.serial, ""});
  if (!device.bus.empty()) candidates.push_back({"", "", device.bus});
  for (const std::string& link : device.links) candidates.push_back({link, "", ""});
  for (const DeviceIdentity& candidate : candidates) {
    // A serial number with a blank can't be written as one word; one with a line's end would begin
    // another key where it is pasted.
    if (!parse_device_identity(candidate.text())) continue;
    const auto found = find_device(candidate, devices);
    if (found && found->node == device.node) return candidate.text();
  }
  return {};
}

}  // namespace waymark
