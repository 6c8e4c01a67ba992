#pragma once

#include <optional>
#include <string>

#include "core/base/error.h"
#include "drivers/frame.h"

namespace waymark {

/// The seam to one camera, whatever brings its images: v4l2, libcamera, a capture played back.
/// start, next and the destructor are called from one thread, stop from any. Frames may outlive
/// stop, not the source.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// The camera's name in the rig.
  [[nodiscard]] virtual const std::string& name() const = 0;

  /// Opens the device and lets it run. May be called again after stop. Errors say what to do:
  /// unavailable (absent, busy: by whom), permission (which group), config (a format that it can't
  /// deliver: which it can).
  [[nodiscard]] virtual Status start() = 0;

  /// The next frame; nullopt when none came until `deadline` (CLOCK_MONOTONIC), after stop, or when
  /// none will ever come (ended). Waits nowhere else than for the device. A damaged frame is
  /// dropped and counted inside. Errors: unavailable when the device is gone, io when it must be
  /// started again.
  [[nodiscard]] virtual Expected<std::optional<Frame>> next(Stamp deadline) = 0;

  /// Ends a waiting `next` soon; from any thread.
  virtual void stop() = 0;

  /// No frame will ever come again: a capture played to its end.
  [[nodiscard]] virtual bool ended() const { return false; }

  /// Frames that the driver dropped since start: short, flagged as damaged, undecodable.
  [[nodiscard]] virtual std::uint64_t damaged() const { return 0; }
};

}  // namespace waymark
