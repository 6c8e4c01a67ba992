#include "drivers/buffer_lender.h"

#include <algorithm>
#include <mutex>

#include "core/base/check.h"

namespace waymark {

void BufferLender::begin(std::shared_ptr<const void> memory, std::size_t limit, bool copies) {
  end();
  const std::lock_guard lock(mutex_);
  streams_.push_back({next_number_++, std::move(memory), 0});
  running_ = true;
  limit_ = limit;
  copies_ = copies;
  returned_.reserve(kMaxBuffers);
}

void BufferLender::end() {
  const std::lock_guard lock(mutex_);
  if (running_ && streams_.back().lent == 0) streams_.pop_back();
  running_ = false;
  returned_.clear();
}

std::optional<std::uint32_t> BufferLender::lend(std::uint32_t index) {
  WAYMARK_CHECK(index < kMaxBuffers);
  const std::lock_guard lock(mutex_);
  WAYMARK_CHECK(running_);
  Stream& stream = streams_.back();
  if (stream.lent >= limit_) return std::nullopt;
  ++stream.lent;
  return stream.number * kMaxBuffers + index;
}

std::optional<std::uint32_t> BufferLender::take_returned() {
  const std::lock_guard lock(mutex_);
  if (returned_.empty()) return std::nullopt;
  const std::uint32_t index = returned_.back();
  returned_.pop_back();
  return index;
}

void BufferLender::take_back(std::uint32_t slot) noexcept {
  std::shared_ptr<const void> memory;  // let go of outside the lock
  std::unique_lock lock(mutex_);
  const auto stream = std::find_if(streams_.begin(), streams_.end(),
                                   [&](const Stream& s) { return s.number == slot / kMaxBuffers; });
  WAYMARK_CHECK(stream != streams_.end() && stream->lent > 0);
  --stream->lent;
  if (running_ && &*stream == &streams_.back()) {
    // Of what may be lent, the driver had nothing.
    const bool short_of_buffers = !copies_ && stream->lent + 1 + returned_.size() >= limit_;
    returned_.push_back(slot % kMaxBuffers);
    lock.unlock();
    if (short_of_buffers && wake_) wake_();
  } else if (stream->lent == 0) {
    memory = std::move(stream->memory);
    streams_.erase(stream);
  }
}

}  // namespace waymark
