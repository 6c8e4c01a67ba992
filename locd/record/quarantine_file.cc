#include "locd/record/quarantine_file.h"

#include <fcntl.h>
#include <stdio.h>

#include <cerrno>
#include <utility>

#include "core/base/system_call.h"
#include "drivers/monotonic_clock.h"
#include "locd/frames/realtime.h"

namespace waymark {

namespace fs = std::filesystem;

QuarantineFile::~QuarantineFile() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

std::vector<QuarantinedMarker> QuarantineFile::of_map(const std::string& map_hash) {
  {
    const std::lock_guard lock(mutex_);
    if (newest_ && newest_->map_hash == map_hash) return newest_->markers;
  }
  const std::lock_guard lock(disk_);
  auto read = read_or_set_aside();
  if (!read || !*read || (*read)->map_hash != map_hash) return {};
  return std::move((*read)->markers);
}

Quarantine QuarantineFile::known() {
  {
    const std::lock_guard lock(mutex_);
    if (newest_) return *newest_;
  }
  const std::lock_guard lock(disk_);
  auto read = read_or_set_aside();
  return read && *read ? *std::move(*read) : Quarantine{};
}

Expected<std::optional<Quarantine>> QuarantineFile::read_or_set_aside() {
  std::error_code unknown;
  if (fs::symlink_status(path_, unknown).type() == fs::file_type::not_found) return std::nullopt;
  auto read = read_quarantine(path_);
  if (read) return std::move(*read);
  if (auto done = set_aside(read.error()); !done) return tl::make_unexpected(done.error());
  return std::nullopt;
}

Status QuarantineFile::set_aside(const Error& why) {
  // What lies there from an earlier time stays, too.
  const std::string damaged = path_.string() + ".damaged";
  std::string kept = damaged;
  int failed = -1;
  for (int i = 2; i < 100; ++i) {
    failed = ::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, kept.c_str(), RENAME_NOREPLACE);
    if (failed == 0 || errno != EEXIST) break;
    kept = fmt::format("{}.{}", damaged, i);
  }
  const std::string reason = system_reason();
  const std::lock_guard lock(mutex_);
  const std::string before = damage_;
  damage_ = in_one_line(
      failed == 0
          ? fmt::format("quarantine not used, and kept as {}: {}", kept, why.message)
          : fmt::format("quarantine not used, and nothing is written in its place, for it can't be "
                        "renamed to {}: {}: {}",
                        kept, reason, why.message));
  if (damage_ != before) news_.push_back({damage_, true});
  if (failed == 0) return {};
  return fail(ErrorKind::io, "{}", damage_);
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
  while (wait_for_work(lock)) {
    const Quarantine quarantine = *newest_;
    const bool last = ending_;
    due_ = hurry_ = false;
    writing_ = true;
    lock.unlock();
    const Status written = replace_by(quarantine);
    lock.lock();
    writing_ = false;
    tell_failure(written);
    if (written) {
      if (!due_) newest_.reset();
      pauses_.begin_anew();
    } else {
      due_ = true;
      next_attempt_ = monotonic_now() + pauses_.next();
    }
    changed_.notify_all();
    if (last) return;
  }
}

bool QuarantineFile::wait_for_work(std::unique_lock<std::mutex>& lock) {
  for (;;) {
    if (due_ && (ending_ || hurry_ || monotonic_now() >= next_attempt_)) return true;
    if (ending_) return false;
    if (due_) {
      changed_.wait_until(lock, as_time_point(next_attempt_));
    } else {
      changed_.wait(lock);
    }
  }
}

Status QuarantineFile::replace_by(const Quarantine& quarantine) {
  const std::lock_guard lock(disk_);
  const auto usable = read_or_set_aside();
  if (!usable) return tl::make_unexpected(usable.error());
  return write_quarantine(path_, quarantine);
}

void QuarantineFile::tell_failure(const Status& written) {
  const std::string before = std::exchange(failure_, written ? "" : written.error().message);
  if (failure_ == before) return;
  news_.push_back(written ? News{path_.string() + ": written again", false} : News{failure_, true});
}

std::string QuarantineFile::trouble() const {
  const std::lock_guard lock(mutex_);
  return failure_.empty() ? damage_ : failure_;
}

std::vector<QuarantineFile::News> QuarantineFile::take_news() {
  std::vector<News> taken;
  const std::lock_guard lock(mutex_);
  taken.swap(news_);
  return taken;
}

bool QuarantineFile::settle(Stamp deadline) {
  std::unique_lock lock(mutex_);
  hurry_ = due_;
  changed_.notify_all();
  return changed_.wait_until(lock, as_time_point(deadline),
                             [&] { return !writing_ && (!due_ || !hurry_); });
}

}  // namespace waymark
