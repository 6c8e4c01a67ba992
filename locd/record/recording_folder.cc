#include "locd/record/recording_folder.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/base/system_call.h"
#include "locd/record/recording_files.h"

namespace waymark {

namespace fs = std::filesystem;

namespace {

/// Written files that wait for sync() at most; more are synced early.
constexpr std::size_t kMaxUnsynced = 256;
/// In which most file systems give room.
constexpr std::uint64_t kBlock_bytes = 4096;

std::uint64_t in_blocks(std::size_t bytes) {
  return (bytes + kBlock_bytes - 1) / kBlock_bytes * kBlock_bytes;
}

std::string_view name_of(StampQuality quality) {
  switch (quality) {
    case StampQuality::exact:
      return "exact";
    case StampQuality::approximate:
      return "approximate";
    case StampQuality::arrival:
      return "arrival";
    case StampQuality::replayed:
      return "replayed";
  }
  return "";
}

/// The text as a field of a CSV table.
std::string csv_field(std::string_view text) {
  std::string field = "\"";
  for (const char c : text) field.append(c == '"' ? 2 : 1, c);
  return field + "\"";
}

std::string capture_toml(const RecordingFacts& facts) {
  const auto tolerance_us =
      std::chrono::duration_cast<std::chrono::microseconds>(facts.sync_tolerance).count();
  return fmt::format(
      "clock = \"realtime\"\nsession = \"{}\"\nsync_tolerance_us = {}\ncodec = \"{}\"\n"
      "{}{}\"\n",
      facts.session_id, tolerance_us, facts.codec, kRecordedByLocd, facts.version);
}

/// Whether nothing is there yet but what a kill left of the first files.
bool is_untouched(const OwnFolder& folder) {
  bool untouched = true;
  folder.each_name([&](const std::string& name) { untouched = untouched && name[0] == '.'; });
  return untouched;
}

/// Whether it is a recording of locd's with this rig.
bool goes_on(const OwnFolder& folder, const std::string& rig_yaml) {
  if (!recorded_by_locd(folder)) return false;
  const auto earlier = read_file(folder.path() / "rig.yaml");
  return earlier ? *earlier == rig_yaml : earlier.error().kind == ErrorKind::no_input;
}

/// What a killed process left half-written.
void remove_unfinished(const OwnFolder& folder) {
  std::vector<std::string> names;
  folder.each_name([&](const std::string& name) {
    if (is_unfinished(name)) names.push_back(name);
  });
  for (const std::string& name : names) (void)folder.remove(name);
}

}  // namespace

RecordingFolder::RecordingFolder(OwnFolder folder, const RecordingFacts& facts,
                                 const RecordingBudget& budget)
    : folder_(std::move(folder)),
      cameras_(facts.cameras),
      codec_(facts.codec),
      capture_toml_(capture_toml(facts)),
      budget_(budget),
      date_known_(facts.date_known) {
  unsynced_.reserve(kMaxUnsynced + cameras_.size());
}

Expected<RecordingFolder> RecordingFolder::open(const fs::path& path, const RecordingFacts& facts,
                                                const RecordingBudget& budget) {
  std::error_code failed;
  fs::create_directories(path, failed);
  if (failed) {
    errno = failed.value();
    return fail(creation_error(), "{}: can't create: {}", path.string(), system_reason());
  }
  auto opened = OwnFolder::open(path);
  if (!opened) return tl::make_unexpected(opened.error());
  RecordingFolder folder(std::move(*opened), facts, budget);
  const bool untouched = is_untouched(folder.folder_);
  if (!untouched && !goes_on(folder.folder_, facts.rig_yaml)) {
    return fail(
        ErrorKind::cant_create,
        "{}: can't record here: it is not empty, and no recording of locd's with this rig; name "
        "another folder",
        path.string());
  }
  const bool part_is_dated = untouched || waymark::date_known(folder.folder_);
  folder.may_say_date_known_ = part_is_dated;
  if (auto written = folder.write_texts(facts); !written) {
    return tl::make_unexpected(written.error());
  }
  if (auto opened = folder.open_folders(); !opened) return tl::make_unexpected(opened.error());
  if (auto known = folder.look_at_earlier(facts, part_is_dated); !known) {
    return tl::make_unexpected(known.error());
  }
  return folder;
}

Status RecordingFolder::write_texts(const RecordingFacts& facts) {
  // By the first the folder is known as locd's own.
  if (auto written = say_whether_date_is_known(); !written) return written;
  folder_.learn_owner(kCaptureToml);
  for (const auto& [name, text] :
       {std::pair{"rig.yaml", &facts.rig_yaml}, std::pair{"markers.toml", &facts.markers_toml}}) {
    if (text->empty()) continue;
    if (auto written = write_text(name, *text); !written) return written;
  }
  return {};
}

Status RecordingFolder::say_whether_date_is_known() {
  says_date_known_ = may_say_date_known_ && date_known_;
  return write_text(kCaptureToml, capture_toml_ + (says_date_known_ ? kDateKnown : kDateNotKnown));
}

Status RecordingFolder::write_text(const char* name, const std::string& text) {
  if (auto ours = folder_.check_writable(name); !ours) return ours;
  return write_file_atomically(path() / name, text);
}

Status RecordingFolder::open_folders() {
  remove_unfinished(folder_);
  for (const std::string& camera : cameras_) {
    auto opened = folder_.make_folder(camera);
    if (!opened) return tl::make_unexpected(opened.error());
    remove_unfinished(*opened);
    folders_.push_back(std::move(*opened));
  }
  auto table = FrameTable::open(folder_);
  if (!table) return tl::make_unexpected(table.error());
  table_.emplace(std::move(*table));
  return {};
}

Status RecordingFolder::look_at_earlier(const RecordingFacts& facts, bool part_is_dated) {
  RecordingOnDisk part = RecordingOnDisk::earlier_part_of(folder_, part_is_dated);
  std::optional<OwnFolder> archive;
  if (!facts.archive.empty()) {
    auto opened = OwnFolder::open(facts.archive);
    if (!opened) return tl::make_unexpected(opened.error());
    opened->take_owner_of(folder_);
    archive.emplace(std::move(*opened));
  }
  earlier_ = RecordingArchive(archive, folder_, std::move(part), facts.sync_tolerance);
  return {};
}

Expected<bool> RecordingFolder::write_set(const std::vector<RecordedImage>& images) {
  const std::string rows = rows_of(images);
  SetOnDisk set;
  set.stamp = images.front().info.stamp;
  for (const RecordedImage& image : images) set.bytes += in_blocks(image.bytes.size());
  DeletionAllowance allowance(set.bytes);
  if (auto room = make_room(set.bytes + rows.size(), allowance); !room || !*room) return room;
  if (auto rewritten = forget_deleted_rows(); !rewritten) {
    return tl::make_unexpected(rewritten.error());
  }
  for (const RecordedImage& image : images) {
    if (auto written = write_image(image); !written) {
      delete_set(set);
      return tl::make_unexpected(written.error());
    }
    set.images.push_back({image.camera, image.info.stamp});
  }
  if (auto appended = table_->append(rows); !appended) {
    delete_set(set);
    return tl::make_unexpected(appended.error());
  }
  listed_ += set.images.size();
  set_images_ += set.images.size();
  set_bytes_ += set.bytes;
  sets_.push_back(std::move(set));
  delete_outdated(allowance);
  if (unsynced_.size() >= kMaxUnsynced) {
    if (auto synced = sync(); !synced) return tl::make_unexpected(synced.error());
  }
  return true;
}

std::uint64_t RecordingFolder::bytes() const {
  const RecordingOnDisk* const part = earlier_.earlier_part();
  return set_bytes_ + table_->bytes() + (part != nullptr ? part->bytes() : 0);
}

std::uint64_t RecordingFolder::sets() const {
  const RecordingOnDisk* const part = earlier_.earlier_part();
  return sets_.size() + (part != nullptr ? part->sets() : 0);
}

std::uint64_t RecordingFolder::images() const {
  const RecordingOnDisk* const part = earlier_.earlier_part();
  return set_images_ + (part != nullptr ? part->images() : 0);
}

Expected<std::uint64_t> RecordingFolder::free_bytes() const {
  struct statvfs disk {};
  if (::fstatvfs(folder_.descriptor(), &disk) == 0) {
    return std::uint64_t{disk.f_bavail} * disk.f_frsize;
  }
  return fail(ErrorKind::io, "{}: can't ask for free space: {}", path().string(), system_reason());
}

tl::unexpected<Error> RecordingFolder::no_room(std::uint64_t free_bytes) const {
  return fail(ErrorKind::io,
              "{}: {} bytes are free, {} must stay free; make room, or lower [record] "
              "min_free_bytes",
              path().string(), free_bytes, budget_.min_free_bytes);
}

Expected<bool> RecordingFolder::make_room(std::uint64_t bytes, DeletionAllowance& allowance) {
  if (bytes > budget_.max_bytes) {
    return fail(ErrorKind::io,
                "{}: a frame set takes {} bytes, and [record] max_bytes is {}; raise it",
                path().string(), bytes, budget_.max_bytes);
  }
  const auto is_too_much = [&] {
    return earlier_.bytes() + set_bytes_ + table_->bytes() + bytes > budget_.max_bytes;
  };
  while (earlier_.is_known() && is_too_much() && has_oldest() && !allowance.is_used_up()) {
    delete_oldest(allowance);
  }
  return make_room_on_disk(bytes, allowance);
}

Expected<bool> RecordingFolder::make_room_on_disk(std::uint64_t bytes,
                                                  DeletionAllowance& allowance) {
  const std::uint64_t needed = budget_.min_free_bytes + bytes;
  for (;;) {
    const auto free = free_bytes();
    if (!free) return tl::make_unexpected(free.error());
    if (*free >= needed) return true;
    if (!earlier_.is_known()) return false;
    // Somebody else has filled the disk: all that could be deleted would not make up for it.
    if (*free + set_bytes_ + earlier_.bytes() < needed || !has_oldest()) return no_room(*free);
    if (allowance.is_used_up()) return false;
    const std::uint64_t deleted = delete_oldest(allowance);
    if (auto freed = check_freed(*free, deleted); !freed) {
      return tl::make_unexpected(freed.error());
    }
  }
}

Status RecordingFolder::check_freed(std::uint64_t before, std::uint64_t deleted) const {
  std::uint64_t now = 0;
  // Some file systems give room back with what they bring to the disk next.
  for (const bool brought : {false, true}) {
    if (brought) ::syncfs(folder_.descriptor());
    const auto free = free_bytes();
    if (!free) return tl::make_unexpected(free.error());
    now = *free;
    if (now >= before + deleted / 2) return {};
  }
  return fail(
      ErrorKind::io,
      "{}: {} bytes of recordings were deleted, and {} bytes are free instead of {}: others "
      "fill the disk, or snapshots keep what is deleted; nothing more is; make room",
      path().string(), deleted, now, before);
}

template <typename Delete>
auto RecordingFolder::forgetting(const Delete& delete_something) {
  const std::uint64_t before = images();
  auto deleted = delete_something();
  listed_ -= std::min(listed_, before - images());
  (void)forget_deleted_rows();  // a full disk may take it only once there is room
  return deleted;
}

void RecordingFolder::delete_outdated(DeletionAllowance& allowance) {
  const Stamp limit = sets_.back().stamp - budget_.keep;
  while (!allowance.is_used_up()) {
    const auto deleted = forgetting([&]() -> std::optional<std::uint64_t> {
      if (date_known_ && earlier_.is_known()) {
        if (const auto earlier = earlier_.delete_outdated_set(limit)) return earlier;
      }
      if (sets_.front().stamp >= limit) return std::nullopt;
      return delete_oldest_own();
    });
    if (!deleted) return;
    allowance.take(*deleted);
  }
}

std::uint64_t RecordingFolder::delete_oldest(DeletionAllowance& allowance) {
  const std::uint64_t deleted = forgetting(
      [&] { return earlier_.empty() ? delete_oldest_own() : earlier_.delete_oldest_set(); });
  allowance.take(deleted);
  return deleted;
}

Status RecordingFolder::forget_deleted_rows() {
  // What the table lists of an earlier run is known once it is read; then it is rewritten.
  if (!earlier_.is_known() || table_->rows() <= 2 * listed_) return {};
  auto rewritten = table_->forget_all_but(
      [&](std::string_view camera, Stamp stamp) { return is_there(camera, stamp); });
  if (rewritten) listed_ = table_->rows();
  return rewritten;
}

bool RecordingFolder::is_there(std::string_view camera, Stamp stamp) const {
  const auto index = std::find(cameras_.begin(), cameras_.end(), camera) - cameras_.begin();
  if (index == std::ssize(cameras_)) return false;
  const OwnFolder& folder = folders_[static_cast<std::size_t>(index)];
  const auto has = [&](std::string_view codec) {
    const auto bytes = folder.own_bytes(image_name(stamp, codec));
    return bytes || bytes.error().kind != ErrorKind::no_input;
  };
  return has("pgm") || has("jpeg");
}

std::uint64_t RecordingFolder::delete_oldest_own() {
  const SetOnDisk oldest = std::move(sets_.front());
  sets_.pop_front();
  set_images_ -= oldest.images.size();
  set_bytes_ -= oldest.bytes;
  return delete_set(oldest);
}

std::uint64_t RecordingFolder::delete_set(const SetOnDisk& set) {
  std::uint64_t deleted = 0;
  for (const ImageOnDisk& image : set.images) {
    const auto removed = folders_[image.camera].remove(image_name(image.stamp, codec_));
    if (removed) {
      deleted += *removed;
    } else if (undeletable_.empty() && removed.error().kind != ErrorKind::no_input) {
      undeletable_ = removed.error().message;
    }
  }
  return deleted;
}

std::vector<std::string> RecordingFolder::take_notes() {
  std::vector<std::string> notes = earlier_.take_notes();
  if (!undeletable_.empty() && !std::exchange(undeletable_told_, true)) {
    notes.push_back(
        fmt::format("{}: what is too much or too old can't all be deleted; it stays and "
                    "does not count for [record] max_bytes: {}",
                    path().string(), undeletable_));
  }
  return notes;
}

Status RecordingFolder::write_image(const RecordedImage& image) {
  const OwnFolder& folder = folders_[image.camera];
  const std::string name = image_name(image.info.stamp, codec_);
  const std::string hidden = unfinished_name(name);
  Descriptor file = folder.create(hidden);
  const auto failed = [&] {
    const std::string why = system_reason();
    if (file.valid()) (void)folder.remove(hidden);
    return fail(ErrorKind::io, "{}: can't write: {}", (folder.path() / name).string(), why);
  };
  if (!file.valid() || !write_all(file.get(), image.bytes)) return failed();
  // The kernel begins to write at once, so that the sync of a second's images is not one long stop.
  ::sync_file_range(file.get(), 0, 0, SYNC_FILE_RANGE_WRITE);
  if (!folder.rename(hidden, name)) return failed();
  unsynced_.push_back(std::move(file));
  return {};
}

std::string RecordingFolder::rows_of(const std::vector<RecordedImage>& images) const {
  std::string rows;
  for (const RecordedImage& image : images) {
    fmt::format_to(std::back_inserter(rows), "{},{},{},{},{}\n", cameras_[image.camera],
                   image.info.stamp.count(), image.info.exposure.count(), image.info.sequence,
                   name_of(image.info.quality));
  }
  return rows;
}

Status RecordingFolder::mark(Stamp stamp, std::string_view text) {
  std::string rows;
  if (!marks_.valid()) {
    auto opened = folder_.open_to_append(kMarkTable);
    if (!opened) return tl::make_unexpected(opened.error());
    marks_ = std::move(*opened);
    if (::lseek(marks_.get(), 0, SEEK_END) == 0) rows = "t_ns,text\n";
  }
  rows += fmt::format("{},{}\n", stamp.count(), csv_field(text));
  if (write_all(marks_.get(), rows)) return {};
  return fail(ErrorKind::io, "{}: can't write: {}", (path() / kMarkTable).string(),
              system_reason());
}

Status RecordingFolder::sync() {
  bool good = !marks_.valid() || ::fdatasync(marks_.get()) == 0;
  for (const Descriptor& file : unsynced_) good = ::fdatasync(file.get()) == 0 && good;
  unsynced_.clear();
  for (const OwnFolder& folder : folders_) good = ::fsync(folder.descriptor()) == 0 && good;
  good = table_->sync() && good;
  if (good && date_known_ && may_say_date_known_ && !says_date_known_) {
    return say_whether_date_is_known();
  }
  if (good) return {};
  return fail(ErrorKind::io, "{}: can't bring images to the disk: {}", path().string(),
              system_reason());
}

}  // namespace waymark
