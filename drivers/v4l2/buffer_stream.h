#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/v4l2/capture_format.h"
#include "drivers/v4l2/video_node.h"

namespace waymark {

/// The memory-mapped buffers of one video node, streaming. The driver fills those it was given,
/// oldest first; a filled one is ours from take() to give().
class BufferStream {
 public:
  /// Asks for `wanted` buffers, maps them, gives all to the driver and lets it stream. The node
  /// must outlive it. Errors: those of node_error; unavailable for fewer than FrameMaker needs.
  [[nodiscard]] static Expected<std::unique_ptr<BufferStream>> start(VideoNode& node,
                                                                     const CaptureFormat& format,
                                                                     std::size_t wanted);
  ~BufferStream();
  BufferStream(const BufferStream&) = delete;
  BufferStream& operator=(const BufferStream&) = delete;

  [[nodiscard]] std::size_t count() const { return memory_->size(); }
  /// Keeps all buffers mapped, also after this has ended.
  [[nodiscard]] std::shared_ptr<const void> memory() const { return memory_; }

  /// A filled buffer.
  struct Filled {
    std::uint32_t index = 0;
    std::span<const std::uint8_t> bytes;  ///< as many as the driver says it has filled
    std::uint32_t flags = 0;              ///< V4L2_BUF_FLAG_…
    std::uint32_t sequence = 0;           ///< the device's count of frames
    Stamp stamp{0};                       ///< by the clock that the flags tell; see buffer_stamp
  };
  /// nullopt: none is filled. Errors: those of node_error.
  [[nodiscard]] Expected<std::optional<Filled>> take();
  /// Gives a buffer (back) to the driver.
  [[nodiscard]] Status give(std::uint32_t index);

 private:
  struct Mapping {
    std::shared_ptr<const std::uint8_t> bytes;
    std::size_t length = 0;
  };
  using Memory = std::vector<Mapping>;

  BufferStream(VideoNode& node, const CaptureFormat& format)
      : node_(node), type_(format.buffer_type()), planes_(format.planes) {}

  /// A request about one buffer, with room for its planes.
  struct Query;
  [[nodiscard]] Status map_buffers(std::size_t count);

  VideoNode& node_;
  v4l2_buf_type type_;
  std::size_t planes_;
  std::shared_ptr<Memory> memory_ = std::make_shared<Memory>();
  bool streams_ = false;
};

}  // namespace waymark
