#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/stamp.h"

namespace waymark {

/// A process that has a device open.
struct DeviceHolder {
  int pid = 0;
  std::string program;
};

/// One open video node, by the system calls that it takes. A seam: tests put a scripted device
/// here.
class VideoNode {
 public:
  virtual ~VideoNode() = default;

  /// /dev/video2, for messages.
  [[nodiscard]] virtual const std::string& path() const = 0;

  /// ioctl: 0, or the error's number.
  [[nodiscard]] virtual int request(unsigned long code, void* argument) = 0;

  /// `length` bytes at the driver's `offset`, readable until the last owner lets go, also after
  /// the node is closed; null when the driver refuses.
  [[nodiscard]] virtual std::shared_ptr<const std::uint8_t> map(std::size_t length,
                                                                std::int64_t offset) = 0;

  /// Waits for a filled buffer until `deadline` (CLOCK_MONOTONIC) or until the descriptor
  /// `interrupt` is readable; true: there is a buffer or an error to take.
  [[nodiscard]] virtual bool wait(Stamp deadline, int interrupt) = 0;

  /// Who has the device open, this process otherwise than by this node included; as far as we may
  /// see.
  [[nodiscard]] virtual std::vector<DeviceHolder> holders() const = 0;
};

/// A video node that the system has, and by what its camera can be told from others.
struct VideoDevice {
  std::string node;                ///< /dev/video2: a number, which changes
  std::vector<std::string> links;  ///< stable names: /dev/v4l/by-id/…, by-path, /dev/waymark/…
  std::string bus;     ///< of USB the port, usb-0000:00:14.0-2; of others what the driver says once
                       ///< opened, platform:vivid-000
  std::string serial;  ///< of its USB device; empty where it states none
  std::string card;    ///< what the maker calls it; once opened
  /// False: we may not open it, so its bus, and whether it is a camera at all, is not known.
  bool permitted = true;
};

/// The video devices of a machine, and its time. Used from several threads.
class VideoSystem {
 public:
  virtual ~VideoSystem() = default;

  /// All video nodes, sorted by number, with what is known of them without opening any: a device
  /// that hangs must not hold up another's camera.
  [[nodiscard]] virtual std::vector<VideoDevice> nodes() = 0;
  /// Errors: unavailable when it has gone, permission naming the group.
  [[nodiscard]] virtual Expected<std::unique_ptr<VideoNode>> open(const std::string& node) = 0;
  /// CLOCK_MONOTONIC.
  [[nodiscard]] virtual Stamp now() const = 0;
};

/// This machine's kernel.
[[nodiscard]] std::shared_ptr<VideoSystem> kernel_video_system();

}  // namespace waymark
