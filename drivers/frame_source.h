#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "drivers/frame.h"

namespace waymark {

/// What a camera's device is, without starting it.
struct DeviceReport {
  std::string text;          ///< in a line: which device, what it can do
  std::vector<int> holders;  ///< processes that have it open, where that can be seen
};

/// The seam to one camera, whatever brings its images: v4l2, libcamera, a capture played back.
/// start, next and close are called from one thread, stop from any. Frames may outlive close, not
/// the source.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// The camera's name in the rig.
  [[nodiscard]] virtual const std::string& name() const = 0;

  /// Opens the device and lets it run; a second call opens it anew. Errors say what to do:
  /// unavailable (absent, twofold, busy: by whom), permission (which group), io (it may work next
  /// time), config (nothing but another configuration helps: a format that it can't deliver,
  /// another serial number).
  [[nodiscard]] virtual Status start() = 0;

  /// The next frame; nullopt when none came until `deadline` (CLOCK_MONOTONIC), after stop, or when
  /// none will ever come (ended). Waits nowhere else than for the device. A damaged frame is
  /// dropped and counted inside. Errors: unavailable when the device is gone, io when it must be
  /// started again, config for what only the first frame shows.
  [[nodiscard]] virtual Expected<std::optional<Frame>> next(Stamp deadline) = 0;

  /// Ends a waiting `next` soon; from any thread.
  virtual void stop() = 0;

  /// Gives the device back to the system; frames that are lent stay as they are.
  virtual void close() {}

  /// When a call to the device last returned (CLOCK_MONOTONIC), from any thread: a start of many
  /// slow calls goes on, one that is stuck in a call does not. 0: not told.
  [[nodiscard]] virtual Stamp last_turn() const { return Stamp{0}; }

  /// No frame will ever come again: a capture played to its end.
  [[nodiscard]] virtual bool ended() const { return false; }

  /// Frames that the driver dropped, ever: short, flagged as damaged, undecodable.
  [[nodiscard]] virtual std::uint64_t damaged() const { return 0; }

  /// Frames taken by the device but never given out, ever: gaps in its count, and those that came
  /// while as many buffers were lent as may be.
  [[nodiscard]] virtual std::uint64_t lost() const { return 0; }

  /// What another program has changed of how the device takes its images, until that is found to be
  /// mended; empty: nothing. Told by the thread that calls next.
  [[nodiscard]] virtual std::string_view changed_settings() const { return {}; }

  /// What the device is and can do. Errors: unavailable when it is absent, permission.
  [[nodiscard]] virtual Expected<DeviceReport> inspect() = 0;

  /// What runs, after start, in a line: format, rate, exposure, what stamps mean.
  [[nodiscard]] virtual std::string describe() const { return {}; }
};

}  // namespace waymark
