#include "locd/record/recorder.h"

#include <cstring>

#include "core/base/check.h"
#include "core/capture/jpeg.h"
#include "core/capture/pgm.h"
#include "drivers/monotonic_clock.h"
#include "locd/frames/realtime.h"
#include "locd/record/recording_archive.h"

namespace waymark {

namespace {

Expected<RecordingFolder> open_folder(const std::filesystem::path& folder,
                                      const RecordingFacts& facts, const RecordingBudget& budget) {
  if (!folder.empty()) return RecordingFolder::open(folder, facts, budget);
  const auto created = new_recording_folder(facts.archive, facts.name);
  if (!created) return tl::make_unexpected(created.error());
  return RecordingFolder::open(*created, facts, budget);
}

}  // namespace

Status RecorderOptions::check() const {
  return RangeCheck()
      .field("jpeg_quality", jpeg_quality, kJpegQuality)
      .field("every_nth", every_nth, kEveryNth)
      .status();
}

Recorder::~Recorder() {
  stop();
  if (thread_.joinable()) thread_.join();
}

void Recorder::start(const std::filesystem::path& folder, const RecordingFacts& facts,
                     const RecorderOptions& options) {
  WAYMARK_CHECK(options.check().has_value());
  if (thread_.joinable()) thread_.join();  // it has ended, or is about to
  const std::lock_guard lock(mutex_);
  WAYMARK_CHECK(state_.phase == Phase::idle);
  options_ = options;
  next_budget_.reset();
  marks_.clear();
  stopping_ = false;
  offered_ = 0;
  state_ = {Phase::starting, {}, state_.begun, 0, 0, state_.drops, std::nullopt};
  thread_ = std::thread([this, folder, facts] { run(folder, facts); });
}

void Recorder::stop() {
  const std::lock_guard lock(mutex_);
  if (state_.phase == Phase::idle) return;
  stopping_ = true;
  state_.phase = Phase::stopping;
  changed_.notify_all();
}

void Recorder::set_budget(const RecordingBudget& budget) {
  const std::lock_guard lock(mutex_);
  next_budget_ = budget;
}

bool Recorder::mark(Stamp stamp, std::string text) {
  const std::lock_guard lock(mutex_);
  if (state_.phase != Phase::recording || marks_.size() == kMostMarks) return false;
  marks_.emplace_back(stamp, std::move(text));
  return true;
}

Status Recorder::adopt_news(RecordingFolder& folder) {
  folder.set_date_known(date_known_);
  std::vector<std::pair<Stamp, std::string>> marks;
  {
    const std::lock_guard lock(mutex_);
    if (next_budget_) folder.set_budget(*next_budget_);
    next_budget_.reset();
    marks.swap(marks_);
  }
  for (const auto& [stamp, text] : marks) {
    if (auto noted = folder.mark(stamp, text); !noted) return noted;
  }
  return {};
}

bool Recorder::settle(Stamp deadline) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_until(lock, as_time_point(deadline), [&] {
    return state_.phase == Phase::idle || state_.phase == Phase::recording;
  });
}

void Recorder::offer(const FrameSetLease& set, Stamp utime_offset) {
  const auto slot = take_free_slot();
  if (!slot) return;
  slots_[*slot].utime_offset = utime_offset;
  // Listed neither as free nor as filled, so nobody else touches it.
  copy(set, slots_[*slot]);
  {
    const std::lock_guard lock(mutex_);
    filled_.push_back(*slot);
  }
  changed_.notify_all();
}

std::optional<std::size_t> Recorder::take_free_slot() {
  const std::lock_guard lock(mutex_);
  if (state_.phase != Phase::recording) return std::nullopt;
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

void Recorder::run(const std::filesystem::path& path, const RecordingFacts& facts) {
  name_thread("recorder");
  Status how;
  {
    auto folder = open_folder(path, facts, options_.budget);
    if (folder) {
      begin(*folder, facts.cameras.size());
      how = record(*folder);
    } else {
      how = tl::make_unexpected(folder.error());
    }
    // Closed before the end is told: who starts the next recording waits for nothing.
  }
  end(how);
}

void Recorder::begin(const RecordingFolder& folder, std::size_t cameras) {
  std::vector<Slot> slots(kSlots, Slot{0, Stamp{0}, std::vector<Image>(cameras)});
  for (Slot& slot : slots) {
    for (std::size_t c = 0; c < options_.pixels.size(); ++c) {
      // Written, for pages come with the first write: not while a pose is under way.
      slot.images[c].pixels.assign(options_.pixels[c], 0);
    }
  }
  encoded_.resize(cameras);
  const std::lock_guard lock(mutex_);
  slots_ = std::move(slots);
  filled_.reserve(kSlots);
  for (std::size_t i = 0; i < kSlots; ++i) free_.push_back(i);
  state_.folder = folder.path();
  state_.sets = folder.sets();
  state_.bytes = folder.bytes();
  ++state_.begun;
  if (!stopping_) state_.phase = Phase::recording;
  changed_.notify_all();
}

Status Recorder::record(RecordingFolder& folder) {
  Stamp sync_due = monotonic_now() + kSyncPeriod;
  Status good;
  for (bool done = false; good && !done;) {
    const auto slot = next_filled_slot(sync_due, done);
    good = adopt_news(folder);
    if (slot) {
      const auto written = write(folder, slots_[*slot]);
      if (good && !written) good = tl::make_unexpected(written.error());
      const std::lock_guard lock(mutex_);
      free_.push_back(*slot);
      if (written && !*written) ++state_.drops;
    }
    if (good && (done || monotonic_now() >= sync_due)) {
      good = folder.sync();
      sync_due = monotonic_now() + kSyncPeriod;
    }
    publish_state(folder);
  }
  return good;
}

void Recorder::publish_state(RecordingFolder& folder) {
  const bool known = folder.knows_what_was_there();
  std::vector<std::string> notes = known ? folder.take_notes() : std::vector<std::string>{};
  const std::lock_guard lock(mutex_);
  state_.sets = folder.sets();
  state_.bytes = folder.bytes();
  notes_.insert(notes_.end(), notes.begin(), notes.end());
}

std::optional<std::size_t> Recorder::next_filled_slot(Stamp sync_due, bool& done) {
  std::unique_lock lock(mutex_);
  // A set may just be under copy: its slot is in neither list.
  const auto over = [&] { return stopping_ && free_.size() == slots_.size(); };
  changed_.wait_until(lock, as_time_point(sync_due), [&] { return over() || !filled_.empty(); });
  done = over();
  if (filled_.empty()) return std::nullopt;
  const std::size_t slot = filled_.front();
  filled_.erase(filled_.begin());
  return slot;
}

void Recorder::end(const Status& how) {
  std::vector<Slot> slots;  // given back when nobody waits for the mutex
  std::unique_lock lock(mutex_);
  if (!how) state_.failure = how.error();
  state_.phase = Phase::stopping;
  // A set may just be under copy. What a failed recording has not written is lost.
  changed_.wait(lock, [&] { return free_.size() + filled_.size() == slots_.size(); });
  slots.swap(slots_);
  free_.clear();
  filled_.clear();
  state_.phase = Phase::idle;
  changed_.notify_all();
}

Expected<bool> Recorder::write(RecordingFolder& folder, const Slot& slot) {
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
    info.stamp += slot.utime_offset;
    images.push_back({c, info, encoded_[c]});
  }
  return images.empty() ? Expected<bool>(true) : folder.write_set(images);
}

Recorder::State Recorder::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

std::vector<std::string> Recorder::take_notes() {
  std::vector<std::string> taken;
  const std::lock_guard lock(mutex_);
  taken.swap(notes_);
  return taken;
}

}  // namespace waymark
