#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "tests/vm/uvc_camera/frame_feed.h"

namespace waymark::uvc {

/// Time since the zero of the clock that all cameras of a machine share (CLOCK_MONOTONIC).
using Instant = std::chrono::nanoseconds;

/// Bytes of image per transfer, header included: what the camera promises in
/// dwMaxPayloadTransferSize.
inline constexpr std::uint32_t kMaxPayloadBytes = 16384;

/// Cuts frames into payloads with UVC headers, each frame when its time has come. Frame k belongs
/// to the instant k · period, so that cameras that share a clock expose together; whoever reads too
/// slowly, or far too late, loses whole frames.
class VideoStream {
 public:
  explicit VideoStream(FrameFeed feed) : feed_(std::move(feed)) {}

  /// The first frame is the next whose time has not come.
  void start(Instant now);
  void stop() { streaming_ = false; }
  [[nodiscard]] bool streaming() const { return streaming_; }
  [[nodiscard]] const CameraFormat& format() const { return feed_.format; }

  /// When the next payload is there; nullopt: not unless something changes.
  [[nodiscard]] std::optional<Instant> due() const;
  /// The next payload of at most `room` bytes (≥ 3); nullopt before it is due.
  [[nodiscard]] std::optional<Bytes> next_payload(Instant now, std::uint32_t room);

  // What goes wrong, on request.
  void stall(bool yes) { stalled_ = yes; }  ///< no frames, the device is there
  void freeze(bool yes) { frozen_ = yes; }  ///< one image for ever
  /// Nothing but about this grey level, with a sensor's noise; nullopt: images again.
  void paint(std::optional<std::uint8_t> grey) { grey_ = grey; }
  void shorten(int frames) { short_ = frames; }  ///< so many end half-way

  struct Counts {
    std::int64_t starts = 0;
    std::int64_t sent = 0;
    std::int64_t skipped = 0;
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  [[nodiscard]] bool within_frame() const { return offset_ > 0; }
  void begin_frame(Instant now);

  FrameFeed feed_;
  bool streaming_ = false;
  bool stalled_ = false;
  bool frozen_ = false;
  std::optional<std::uint8_t> grey_;
  int short_ = 0;
  std::int64_t index_ = 0;  ///< of the frame under way, or the next
  Bytes frame_;
  std::size_t end_ = 0;      ///< bytes of the frame that will be sent
  std::size_t offset_ = 0;   ///< bytes sent
  std::uint8_t parity_ = 0;  ///< the header's frame bit, which changes with every frame
  Counts counts_;
};

}  // namespace waymark::uvc
