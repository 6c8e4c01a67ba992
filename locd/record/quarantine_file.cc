#include "locd/record/quarantine_file.h"

#include "drivers/monotonic_clock.h"
#include "locd/frames/realtime.h"

namespace waymark {

QuarantineFile::~QuarantineFile() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

std::vector<QuarantinedMarker> QuarantineFile::of_map(const std::string& map_hash) const {
  {
    const std::lock_guard lock(mutex_);
    if (newest_ && newest_->map_hash == map_hash) return newest_->markers;
  }
  auto read = read_quarantine(path_);
  if (!read || read->map_hash != map_hash) return {};
  return std::move(read->markers);
}

void QuarantineFile::write(Quarantine quarantine) {
  const std::lock_guard lock(mutex_);
  newest_ = std::move(quarantine);
  due_ = true;
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  changed_.notify_all();
}

void QuarantineFile::run() {
  name_thread("quarantine");
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return due_ || ending_; });
    if (!due_) return;
    const Quarantine quarantine = *newest_;
    due_ = false;
    writing_ = true;
    lock.unlock();
    const Status written = write_quarantine(path_, quarantine);
    lock.lock();
    writing_ = false;
    if (!written) failure_ = written.error();
    if (written && !due_) newest_.reset();
    changed_.notify_all();
  }
}

std::optional<Error> QuarantineFile::take_failure() {
  std::optional<Error> taken;
  const std::lock_guard lock(mutex_);
  taken.swap(failure_);
  return taken;
}

bool QuarantineFile::settle(Stamp deadline) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_until(lock, as_time_point(deadline), [&] { return !due_ && !writing_; });
}

}  // namespace waymark
