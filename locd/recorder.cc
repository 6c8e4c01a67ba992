#include "locd/recorder.h"

#include <cstring>

#include "core/capture/jpeg.h"
#include "core/capture/pgm.h"
#include "drivers/monotonic_clock.h"
#include "locd/realtime.h"

namespace waymark {

Recorder::~Recorder() { stop(); }

Status Recorder::start(const std::filesystem::path& path, const RecordingFacts& facts,
                       const RecorderOptions& options) {
  stop();
  auto folder = RecordingFolder::open(path, facts, options.budget);
  if (!folder) return tl::make_unexpected(folder.error());
  const std::lock_guard lock(mutex_);
  options_ = options;
  stopping_ = false;
  offered_ = 0;
  slots_.assign(kSlots, Slot{0, std::vector<Image>(facts.cameras.size())});
  for (Slot& slot : slots_) {
    for (std::size_t c = 0; c < options.pixels.size(); ++c) {
      slot.images[c].pixels.reserve(options.pixels[c]);
    }
  }
  free_.clear();
  filled_.clear();
  filled_.reserve(kSlots);
  for (std::size_t i = 0; i < kSlots; ++i) free_.push_back(i);
  encoded_.resize(facts.cameras.size());
  state_ = {true, path, folder->sets(), folder->bytes(), state_.drops, std::nullopt};
  thread_ = std::thread([this, moved = std::move(*folder)]() mutable {
    name_thread("recorder");
    run(std::move(moved));
  });
  return {};
}

void Recorder::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  work_.notify_all();
  if (thread_.joinable()) thread_.join();
  std::unique_lock lock(mutex_);
  // A set may just be under copy.
  work_.wait(lock, [&] { return free_.size() + filled_.size() == slots_.size(); });
  state_.running = false;
  slots_.clear();
  free_.clear();
  filled_.clear();
}

void Recorder::offer(const FrameSetLease& set) {
  const auto slot = take_free_slot();
  if (!slot) return;
  // Listed neither as free nor as filled, so nobody else touches it.
  copy(set, slots_[*slot]);
  {
    const std::lock_guard lock(mutex_);
    filled_.push_back(*slot);
  }
  work_.notify_all();
}

std::optional<std::size_t> Recorder::take_free_slot() {
  const std::lock_guard lock(mutex_);
  if (!state_.running || stopping_) return std::nullopt;
  if (offered_++ % static_cast<std::uint64_t>(options_.every_nth) != 0) return std::nullopt;
  if (free_.empty()) {
    ++state_.drops;
    return std::nullopt;
  }
  const std::size_t slot = free_.back();
  free_.pop_back();
  return slot;
}

void Recorder::copy(const FrameSetLease& set, Slot& slot) {
  slot.cameras = 0;
  for (std::size_t c = 0; c < slot.images.size(); ++c) {
    if (!set.has(c) || !set.frames[c].has_image()) continue;
    slot.cameras |= camera_bit(c);
    const GrayView& view = set.frames[c].image();
    Image& image = slot.images[c];
    image.info = set.frames[c].info();
    image.width_px = view.width_px;
    image.height_px = view.height_px;
    const auto row_bytes = static_cast<std::size_t>(view.width_px);
    image.pixels.resize(row_bytes * static_cast<std::size_t>(view.height_px));
    for (int y = 0; y < view.height_px; ++y) {
      std::memcpy(image.pixels.data() + static_cast<std::size_t>(y) * row_bytes, view.row(y),
                  row_bytes);
    }
  }
}

void Recorder::run(RecordingFolder folder) {
  Stamp sync_due = monotonic_now() + kSyncPeriod;
  Status good;
  while (good) {
    std::optional<std::size_t> slot;
    {
      std::unique_lock lock(mutex_);
      work_.wait_until(lock, as_time_point(sync_due),
                       [&] { return stopping_ || !filled_.empty(); });
      if (!filled_.empty()) {
        slot = filled_.front();
        filled_.erase(filled_.begin());
      } else if (stopping_) {
        break;
      }
    }
    if (slot) {
      good = write(folder, slots_[*slot]);
      const std::lock_guard lock(mutex_);
      free_.push_back(*slot);
      state_.sets = folder.sets();
      state_.bytes = folder.bytes();
    }
    if (good && monotonic_now() >= sync_due) {
      good = folder.sync();
      sync_due = monotonic_now() + kSyncPeriod;
    }
  }
  if (good) good = folder.sync();
  const std::lock_guard lock(mutex_);
  state_.running = false;
  if (!good) state_.failure = good.error();
}

Status Recorder::write(RecordingFolder& folder, const Slot& slot) {
  std::vector<RecordedImage> images;
  for (std::size_t c = 0; c < slot.images.size(); ++c) {
    if ((slot.cameras & camera_bit(c)) == 0) continue;
    const Image& image = slot.images[c];
    const GrayView view{image.pixels.data(), image.width_px, image.height_px,
                        static_cast<std::size_t>(image.width_px)};
    if (options_.jpeg) {
      auto bytes = encode_jpeg(view, options_.jpeg_quality);
      if (!bytes) return tl::make_unexpected(bytes.error());
      encoded_[c] = std::move(*bytes);
    } else {
      encoded_[c] = encode_pgm(view);
    }
    FrameInfo info = image.info;
    info.stamp += options_.name_offset;
    images.push_back({c, info, encoded_[c]});
  }
  return images.empty() ? Status{} : folder.write_set(images);
}

Recorder::State Recorder::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

}  // namespace waymark
