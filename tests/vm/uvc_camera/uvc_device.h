#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tests/vm/uvc_camera/camera_controls.h"
#include "tests/vm/uvc_camera/video_stream.h"

namespace waymark::uvc {

/// A USB video camera as its host sees it, whatever carries the requests.
class UvcDevice {
 public:
  explicit UvcDevice(FrameFeed feed) : stream_(std::move(feed)) {}

  /// The answer's bytes, cut to what the host takes; nullopt refuses (a stall).
  [[nodiscard]] std::optional<Bytes> answer(const ControlRequest& request, Instant now);

  /// The host resets the bus or chooses a configuration: nothing streams.
  void reset() { stream_.stop(); }
  [[nodiscard]] VideoStream& stream() { return stream_; }

  /// A mute camera takes requests and never answers them: whoever asks waits.
  [[nodiscard]] bool mute() const { return mute_; }

  /// What a test tells the camera: "stall", "freeze", "mute", "short N", "go" (all is well again),
  /// "status" (counts and controls as JSON). One line, which begins with "error" when refused.
  [[nodiscard]] std::string obey(std::string_view order);

 private:
  [[nodiscard]] std::optional<Bytes> standard(const ControlRequest& request);
  [[nodiscard]] std::optional<Bytes> negotiate(const ControlRequest& request, Instant now);
  [[nodiscard]] std::string status() const;

  VideoStream stream_;
  CameraControls controls_;
  bool mute_ = false;
};

}  // namespace waymark::uvc
