#include "tests/vm/uvc_camera/video_stream.h"

#include <algorithm>

namespace waymark::uvc {
namespace {

// Payload header of UVC 1.0, 2.4.3.3.
constexpr std::size_t kHeaderBytes = 2;
constexpr std::uint8_t kEndOfHeader = 0x80;
constexpr std::uint8_t kEndOfFrame = 0x02;

/// A frame that begins later than this part of a period is left out: it is stamped when it arrives,
/// and must not pass for one of the next instant.
constexpr int kPunctual = 5;

}  // namespace

void VideoStream::start(Instant now) {
  streaming_ = true;
  index_ = now / feed_.format.period() + 1;
  offset_ = 0;
  ++counts_.starts;
}

std::optional<Instant> VideoStream::due() const {
  if (!streaming_ || stalled_) return std::nullopt;
  return within_frame() ? Instant{0} : index_ * feed_.format.period();
}

void VideoStream::begin_frame(Instant now) {
  const std::int64_t newest = now / feed_.format.period();
  counts_.skipped += newest - index_;
  index_ = newest;
  parity_ ^= 1U;
  if (grey_) {
    frame_ = feed_.painted_frame(*grey_, index_);
  } else if (frame_.empty() || !frozen_) {
    frame_ = feed_.frame(index_);
  }
  end_ = frame_.size();
  if (short_ > 0) {
    --short_;
    end_ /= 2;
  }
}

std::optional<Bytes> VideoStream::next_payload(Instant now, std::uint32_t room) {
  const auto when = due();
  if (!when || now < *when) return std::nullopt;
  if (!within_frame()) {
    const std::int64_t newest = now / feed_.format.period();
    if (now - newest * feed_.format.period() > feed_.format.period() / kPunctual) {
      counts_.skipped += newest + 1 - index_;
      index_ = newest + 1;
      return std::nullopt;
    }
    begin_frame(now);
  }
  const std::size_t size =
      std::min<std::size_t>(std::min(room, kMaxPayloadBytes) - kHeaderBytes, end_ - offset_);
  Bytes payload{kHeaderBytes, static_cast<std::uint8_t>(kEndOfHeader | parity_)};
  const auto from = frame_.begin() + static_cast<std::ptrdiff_t>(offset_);
  payload.insert(payload.end(), from, from + static_cast<std::ptrdiff_t>(size));
  offset_ += size;
  if (offset_ == end_) {
    payload[1] |= kEndOfFrame;
    offset_ = 0;
    ++index_;
    ++counts_.sent;
  }
  return payload;
}

}  // namespace waymark::uvc
