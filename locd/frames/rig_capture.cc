#include "locd/frames/rig_capture.h"

#include <algorithm>

#include "core/base/check.h"
#include "drivers/monotonic_clock.h"
#include "locd/frames/realtime.h"

namespace waymark {
namespace {

/// A waiting camera's loop turns at least this often.
constexpr Stamp kTurn = std::chrono::milliseconds(200);

void note_failure(RigCapture::CameraState& state, const Error& error) {
  state.error = error.message;
  state.misconfigured = error.kind == ErrorKind::config;
}

}  // namespace

RigCapture::RigCapture(std::vector<std::unique_ptr<FrameSource>> sources,
                       const SyncOptions& options, const std::vector<Stamp>& stamp_delays)
    : cameras_(sources.size()), synchronizer_(sources.size(), options) {
  WAYMARK_CHECK(stamp_delays.empty() || stamp_delays.size() == sources.size());
  for (std::size_t c = 0; c < sources.size(); ++c) {
    cameras_[c].source = std::move(sources[c]);
    StampGuardOptions guard;
    if (!stamp_delays.empty()) guard.delay = stamp_delays[c];
    cameras_[c].stamps = StampGuard(guard);
  }
}

RigCapture::~RigCapture() { stop(); }

void RigCapture::start(bool realtime) {
  const std::lock_guard lock(mutex_);
  stopping_ = false;
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    WAYMARK_CHECK(!cameras_[c].thread.joinable());
    cameras_[c].thread = std::thread([this, c, realtime] { run(c, realtime); });
  }
}

void RigCapture::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (Camera& camera : cameras_) camera.source->stop();
  for (Camera& camera : cameras_) {
    if (camera.thread.joinable()) camera.thread.join();
  }
}

void RigCapture::run(std::size_t index, bool realtime) {
  Camera& camera = cameras_[index];
  name_thread(camera.source->name());
  // The start of the program has found out whether it may.
  if (realtime) static_cast<void>(make_realtime(kCapturePriority));
  BackOff back_off;
  std::uint64_t retries_seen = 0;
  const auto note = [&](auto&& change) {
    const std::lock_guard lock(mutex_);
    camera.state.last_turn = monotonic_now();
    change(camera.state);
    return !stopping_;
  };
  while (note([&](CameraState&) { retries_seen = retries_; })) {
    const Status started = camera.source->start();
    note([&](CameraState& state) {
      ++state.starts;
      // What ended the last one stands until a frame proves it over.
      state.misconfigured = false;
      if (!started) note_failure(state, started.error());
    });
    bool running = started.has_value();
    for (bool first = true; running && !camera.source->ended();) {
      auto frame = camera.source->next(monotonic_now() + kTurn);
      const bool tells = first && frame && *frame;
      first = first && !tells;
      running = note([&](CameraState& state) {
        state.damaged = camera.source->damaged();
        state.lost = camera.source->lost();
        const std::string_view changed = camera.source->changed_settings();
        if (state.changed_settings != changed) state.changed_settings = changed;
        if (tells) {
          state.description = camera.source->describe();
          state.error.clear();
        }
        if (!frame) note_failure(state, frame.error());
      });
      if (!frame) break;
      if (!*frame) continue;
      back_off.begin_anew();
      deliver(index, std::move(**frame));
    }
    if (camera.source->ended()) break;
    if (!pause(camera, back_off, retries_seen)) break;
  }
  camera.source->close();
  const std::lock_guard lock(mutex_);
  camera.ended = true;
  changed_.notify_all();
}

bool RigCapture::pause(Camera& camera, BackOff& back_off, std::uint64_t retries_seen) {
  std::unique_lock lock(mutex_);
  const Stamp end = monotonic_now() + back_off.next();
  const auto ended = [&] { return stopping_ || retries_ != retries_seen; };
  // To wait for a device is a turn.
  for (Stamp now{0}; !ended() && (now = monotonic_now()) < end;) {
    camera.state.last_turn = now;
    changed_.wait_until(lock, as_time_point(std::min(now + kTurn, end)), ended);
  }
  if (ended()) back_off.begin_anew();
  return !stopping_;
}

void RigCapture::retry() {
  const std::lock_guard lock(mutex_);
  ++retries_;
  changed_.notify_all();
}

void RigCapture::deliver(std::size_t camera, Frame frame) {
  const std::lock_guard lock(mutex_);
  const Stamp now = monotonic_now();
  CameraState& state = cameras_[camera].state;
  state.last_frame = now;
  ++state.frames;
  // Not now: a frame may have been converted since it came.
  const bool admitted = cameras_[camera].stamps.admit(frame, frame.info().arrival);
  state.unsynced = cameras_[camera].stamps.unsynced();
  if (!admitted) {
    ++state.dropped[static_cast<std::size_t>(DropReason::bad_stamp)];
    return;
  }
  synchronizer_.push(camera, std::move(frame), now);
  gather(now);
}

void RigCapture::gather(Stamp now) {
  while (auto set = synchronizer_.take(now)) {
    if (newest_) {
      for (std::size_t c = 0; c < cameras_.size(); ++c) {
        if (!newest_->has(c)) continue;
        ++cameras_[c].state.dropped[static_cast<std::size_t>(DropReason::solver_busy)];
      }
    }
    newest_ = std::move(*set);
  }
  // A frame that came also moves the deadline that the taker waits for.
  changed_.notify_all();
}

std::optional<FrameSetLease> RigCapture::wait(Stamp deadline) {
  std::unique_lock lock(mutex_);
  for (;;) {
    const Stamp now = monotonic_now();
    gather(now);
    if (newest_) {
      std::optional<FrameSetLease> set;
      set.swap(newest_);
      return set;
    }
    const bool over =
        std::all_of(cameras_.begin(), cameras_.end(), [](const Camera& c) { return c.ended; });
    const auto partial_at = synchronizer_.next_deadline();
    if (stopping_ || now >= deadline || (over && !partial_at)) return std::nullopt;
    changed_.wait_until(lock, as_time_point(std::min(deadline, partial_at.value_or(deadline))));
  }
}

bool RigCapture::ended() const {
  const std::lock_guard lock(mutex_);
  return !newest_ && !synchronizer_.next_deadline() &&
         std::all_of(cameras_.begin(), cameras_.end(), [](const Camera& c) { return c.ended; });
}

RigCapture::CameraState RigCapture::state(std::size_t camera) const {
  const std::lock_guard lock(mutex_);
  CameraState state = cameras_[camera].state;
  state.last_turn = std::max(state.last_turn, cameras_[camera].source->last_turn());
  const DropCounts& by_stamps = synchronizer_.dropped(camera);
  for (std::size_t r = 0; r < kDropReasons; ++r) state.dropped[r] += by_stamps[r];
  return state;
}

CameraMask RigCapture::quorum() const {
  const std::lock_guard lock(mutex_);
  return synchronizer_.quorum();
}

}  // namespace waymark
