#include "locd/service/reload_thread.h"

#include "drivers/monotonic_clock.h"
#include "locd/frames/realtime.h"

namespace waymark {

ReloadThread::~ReloadThread() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

void ReloadThread::request() {
  std::optional<Expected<Replacement>> outdated;  // destroyed without the lock
  const std::lock_guard lock(mutex_);
  requested_ = true;
  outdated.swap(prepared_);
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  changed_.notify_all();
}

std::optional<Expected<Replacement>> ReloadThread::take() {
  std::optional<Expected<Replacement>> taken;
  const std::lock_guard lock(mutex_);
  taken.swap(prepared_);
  return taken;
}

bool ReloadThread::settle(Stamp deadline) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_until(lock, as_time_point(deadline),
                             [&] { return !requested_ && !preparing_; });
}

void ReloadThread::run() {
  name_thread("reload");
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return requested_ || ending_; });
    if (ending_) return;
    requested_ = false;
    preparing_ = true;
    lock.unlock();
    std::optional<Expected<Replacement>> prepared = prepare_();
    lock.lock();
    preparing_ = false;
    if (!requested_) prepared_.swap(prepared);
    changed_.notify_all();
    lock.unlock();
    prepared.reset();  // outdated: its threads end without the lock
    lock.lock();
  }
}

}  // namespace waymark
