#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/buffer_lender.h"
#include "drivers/pixel_format.h"

namespace waymark {

/// How a frame lies in a buffer.
struct FrameLayout {
  const PixelFormat* pixels = nullptr;
  int width_px = 0;
  int height_px = 0;
  std::size_t stride_bytes = 0;

  /// Fewer bytes are a short frame.
  [[nodiscard]] std::size_t least_bytes() const;
};

/// Makes frames of a stream's filled buffers: luma is lent where the driver put it, everything else
/// is converted once into an image that is lent instead. As many are lent at most as there are
/// buffers, less two that always stay with the driver. For the camera's own thread; frames may end
/// in any, also after the stream.
class FrameMaker {
 public:
  /// Buffers to ask a driver for. Four frames of a camera are lent at a time at most: one under way
  /// into the synchronizer, one in it, one in the newest set, one being localized (recordings are
  /// copies).
  static constexpr std::size_t kBuffers = 6;
  /// One that is lent, and two for the driver to fill in turn.
  static constexpr std::size_t kFewestBuffers = 3;

  /// `wake` is called, from any thread, when take_returned has something for which the driver
  /// waits. It must not wait.
  explicit FrameMaker(std::function<void()> wake = {}) : lender_(std::move(wake)) {}

  /// A stream begins, of `buffers` buffers that lie in `memory`.
  void begin(const FrameLayout& layout, std::shared_ptr<const void> memory, std::size_t buffers);
  void end();

  /// The device's count of frames without its overflow; gaps are counted as lost.
  [[nodiscard]] std::uint64_t count(std::uint32_t device_sequence);
  /// A frame that is not to be used: flagged as damaged.
  void discard() { ++damaged_; }

  struct Made {
    std::optional<Frame> frame;  ///< none: short, undecodable or too many are lent; counted
    bool whole = false;          ///< the device did its part, whether or not there is a frame
    bool buffer_is_free = true;  ///< to be given back at once
  };
  [[nodiscard]] Made make(std::uint32_t buffer, std::span<const std::uint8_t> bytes,
                          const FrameInfo& info);

  /// A buffer to be given back, whose frame has ended; nullopt: none (any more).
  [[nodiscard]] std::optional<std::uint32_t> take_returned();

  [[nodiscard]] std::uint64_t damaged() const { return damaged_; }
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  /// Whether the running stream gave a frame yet, good or bad.
  [[nodiscard]] bool counted() const { return sequence_.has_value(); }

 private:
  [[nodiscard]] bool in_place() const;
  [[nodiscard]] Made convert(std::span<const std::uint8_t> bytes, const FrameInfo& info);

  FrameLayout layout_;
  BufferLender lender_;
  std::shared_ptr<std::vector<GrayImage>> images_;  ///< of converted frames
  std::vector<std::uint32_t> free_images_;
  std::optional<std::uint64_t> sequence_;  ///< of the last frame; none yet: nullopt
  std::uint32_t device_sequence_ = 0;
  std::uint64_t damaged_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace waymark
