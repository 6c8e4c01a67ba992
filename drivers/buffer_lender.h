#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/priority_mutex.h"
#include "drivers/frame.h"

namespace waymark {

/// Keeps account of the buffers of a camera's stream that are lent out as frames. A buffer that
/// comes back is queued for the camera's own thread, so that destroying a frame never waits for a
/// driver. When a stream ends while some are lent, its memory stays here until the last is back.
class BufferLender final : public FrameLender {
 public:
  /// `wake` is called, from any thread, when a frame ends whose buffer the driver waits for. It
  /// must not wait.
  explicit BufferLender(std::function<void()> wake = {}) : wake_(std::move(wake)) {}

  /// A stream begins whose buffers lie in `memory`; at most `limit` of them are lent at a time. The
  /// driver waits for none of them when they are `copies`.
  void begin(std::shared_ptr<const void> memory, std::size_t limit, bool copies = false);
  /// It ends: what comes back from now on is of no more use.
  void end();

  /// The slot of a frame that takes buffer `index` (< kMaxBuffers) along; nullopt when as many are
  /// lent as may be.
  [[nodiscard]] std::optional<std::uint32_t> lend(std::uint32_t index);

  /// A buffer of the running stream that has come back; nullopt: none (any more).
  [[nodiscard]] std::optional<std::uint32_t> take_returned();

  void take_back(std::uint32_t slot) noexcept override;

  static constexpr std::uint32_t kMaxBuffers = 32;

 private:
  struct Stream {
    std::uint32_t number = 0;
    std::shared_ptr<const void> memory;
    std::size_t lent = 0;
  };

  std::function<void()> wake_;
  PriorityMutex mutex_;
  std::vector<Stream> streams_;  ///< the last one runs, unless ended; the others await frames
  bool running_ = false;
  bool copies_ = false;
  std::size_t limit_ = 0;
  std::uint32_t next_number_ = 0;
  std::vector<std::uint32_t> returned_;
};

}  // namespace waymark
