#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drivers/camera_options.h"
#include "drivers/v4l2/video_node.h"

namespace waymark {

/// "/dev/video2 (Emu Grey, usb-0000:00:14.0-2, serial 4711)", for messages: one line, whatever the
/// device says of itself.
[[nodiscard]] std::string name_of(const VideoDevice& device);

/// Why a node can't be opened that exists, and what helps, for messages.
[[nodiscard]] std::string not_permitted(const std::string& node);

/// Whether a name can stand as it is in locd.toml, in quotes of either kind, and in a terminal.
/// What devices say of themselves need not.
[[nodiscard]] bool is_plain(std::string_view name);

/// Of "/dev/v4l/by-id/…", "serial=…", "bus=…", or "bus=… serial=…". config for anything else, for
/// what is_plain refuses, and for /dev/videoN.
[[nodiscard]] Expected<DeviceIdentity> parse_device_identity(std::string_view text);

/// Every camera that captures video by streaming and may be `wanted`, and what may not be opened to
/// find that out. What can't be `wanted` is not opened.
[[nodiscard]] std::vector<VideoDevice> find_cameras(VideoSystem& system,
                                                    const DeviceIdentity& wanted = {});

/// Whether a device may be the wanted one, by all that is known without opening it: not its bus
/// unless that is USB.
[[nodiscard]] bool may_be(const DeviceIdentity& wanted, const VideoDevice& device);

/// The one device of find_cameras' that fits, among those that may be opened. Errors: permission
/// when none does and one that may not be opened could; unavailable when there is none, or several
/// that can't be told apart by it.
[[nodiscard]] Expected<VideoDevice> find_device(const DeviceIdentity& identity,
                                                const std::vector<VideoDevice>& devices);

/// Whether it is the camera that was calibrated: config when rig.yaml states another serial number
/// than the device.
[[nodiscard]] Status check_serial(const VideoDevice& device, const CameraOptions& options);

/// The shortest identity that tells `device` from all others and is_plain: its serial number, its
/// bus or a link. Empty when nothing does.
[[nodiscard]] std::string identity_among(const VideoDevice& device,
                                         const std::vector<VideoDevice>& devices);

}  // namespace waymark
