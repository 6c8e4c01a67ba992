#include "drivers/v4l2/buffer_stream.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include "core/base/check.h"
#include "core/base/system_call.h"
#include "drivers/v4l2/buffer_stamp.h"
#include "drivers/v4l2/node_error.h"

namespace waymark {

struct BufferStream::Query {
  Query(v4l2_buf_type type, std::size_t planes_of_buffer, std::uint32_t index) {
    buffer.index = index;
    buffer.type = type;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (!multiplanar()) return;
    buffer.length = static_cast<__u32>(planes_of_buffer);
    buffer.m.planes = planes.data();
  }
  Query(const Query&) = delete;  // the buffer points to the planes
  Query& operator=(const Query&) = delete;
  ~Query() = default;

  [[nodiscard]] bool multiplanar() const {
    return buffer.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  }
  [[nodiscard]] std::size_t length() const {
    return multiplanar() ? planes[0].length : buffer.length;
  }
  [[nodiscard]] std::int64_t offset() const {
    return multiplanar() ? planes[0].m.mem_offset : buffer.m.offset;
  }
  /// Where the image begins and ends within the first plane.
  [[nodiscard]] std::size_t begin() const { return multiplanar() ? planes[0].data_offset : 0; }
  [[nodiscard]] std::size_t end() const {
    return multiplanar() ? planes[0].bytesused : buffer.bytesused;
  }

  v4l2_buffer buffer{};
  std::array<v4l2_plane, VIDEO_MAX_PLANES> planes{};
};

Expected<std::unique_ptr<BufferStream>> BufferStream::start(VideoNode& node,
                                                            const CaptureFormat& format,
                                                            std::size_t wanted) {
  WAYMARK_CHECK(wanted >= FrameMaker::kFewestBuffers && wanted <= BufferLender::kMaxBuffers);
  std::unique_ptr<BufferStream> stream(new BufferStream(node, format));
  v4l2_requestbuffers request{};
  request.count = static_cast<__u32>(wanted);
  request.type = stream->type_;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int failed = node.request(VIDIOC_REQBUFS, &request); failed != 0) {
    return tl::make_unexpected(node_error(node, "can't get buffers", failed));
  }
  if (request.count < FrameMaker::kFewestBuffers) {
    return fail(ErrorKind::unavailable, "{}: the driver has only {} buffers; {} are needed",
                node.path(), request.count, FrameMaker::kFewestBuffers);
  }
  const std::size_t count = std::min<std::size_t>(request.count, BufferLender::kMaxBuffers);
  if (auto mapped = stream->map_buffers(count); !mapped) {
    return tl::make_unexpected(mapped.error());
  }
  int type = stream->type_;
  if (const int failed = node.request(VIDIOC_STREAMON, &type); failed != 0) {
    return tl::make_unexpected(node_error(node, "can't stream", failed));
  }
  stream->streams_ = true;
  return stream;
}

BufferStream::~BufferStream() {
  // A device that is gone refuses both; there is nothing more to be done about it.
  int type = type_;
  if (streams_) (void)node_.request(VIDIOC_STREAMOFF, &type);
  // Frames that are still lent keep the memory mapped and, with it, the device taken, unless the
  // buffers are handed back (since Linux 4.20 before they are unmapped).
  v4l2_requestbuffers none{};
  none.type = type_;
  none.memory = V4L2_MEMORY_MMAP;
  (void)node_.request(VIDIOC_REQBUFS, &none);
}

Status BufferStream::map_buffers(std::size_t count) {
  for (std::uint32_t index = 0; index < count; ++index) {
    Query query(type_, planes_, index);
    if (const int failed = node_.request(VIDIOC_QUERYBUF, &query.buffer); failed != 0) {
      return tl::make_unexpected(node_error(node_, "can't ask for a buffer", failed));
    }
    auto bytes = node_.map(query.length(), query.offset());
    if (bytes == nullptr) {
      return fail(ErrorKind::unavailable, "{}: can't map a buffer of {} bytes: {}", node_.path(),
                  query.length(), system_reason());
    }
    memory_->push_back({std::move(bytes), query.length()});
    if (auto given = give(index); !given) return given;
  }
  return {};
}

Expected<std::optional<BufferStream::Filled>> BufferStream::take() {
  Query query(type_, planes_, 0);
  const int failed = node_.request(VIDIOC_DQBUF, &query.buffer);
  if (failed == EAGAIN) return std::nullopt;
  if (failed != 0) {
    return tl::make_unexpected(node_error(node_, "can't take a frame", failed));
  }
  if (query.buffer.index >= memory_->size()) {
    return fail(ErrorKind::io, "{}: the driver names buffer {} of {}", node_.path(),
                query.buffer.index, memory_->size());
  }
  const Mapping& mapping = (*memory_)[query.buffer.index];
  const std::size_t end = std::min(query.end(), mapping.length);
  const std::size_t begin = std::min(query.begin(), end);
  Filled filled;
  filled.index = query.buffer.index;
  filled.bytes = {mapping.bytes.get() + begin, end - begin};
  filled.flags = query.buffer.flags;
  filled.sequence = query.buffer.sequence;
  filled.stamp = buffer_stamp(query.buffer.timestamp);
  return filled;
}

Status BufferStream::give(std::uint32_t index) {
  Query query(type_, planes_, index);
  if (const int failed = node_.request(VIDIOC_QBUF, &query.buffer); failed != 0) {
    return tl::make_unexpected(node_error(node_, "can't give a buffer back", failed));
  }
  return {};
}

}  // namespace waymark
