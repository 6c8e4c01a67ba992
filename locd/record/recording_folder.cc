#include "locd/record/recording_folder.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/base/folder_walk.h"
#include "core/base/system_call.h"
#include "core/base/text_field.h"

namespace waymark {

namespace fs = std::filesystem;

namespace {

/// Written files that wait for sync() at most; more are synced early.
constexpr std::size_t kMaxUnsynced = 256;

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

std::string capture_toml(const RecordingFacts& facts) {
  const auto tolerance_us =
      std::chrono::duration_cast<std::chrono::microseconds>(facts.sync_tolerance).count();
  return fmt::format(
      "clock = \"realtime\"\nsession = \"{}\"\nsync_tolerance_us = {}\ncodec = \"{}\"\n"
      "{}{}\"\n",
      facts.session_id, tolerance_us, facts.codec, kRecordedByLocd, facts.version);
}

/// Whether nothing is there yet but what a kill left of the first files, or a recording of locd's
/// with this rig.
bool may_record_in(const fs::path& folder, const std::string& rig_yaml) {
  bool empty = true;
  walk_folder<fs::directory_iterator>(folder, [&](const fs::directory_entry& entry) {
    empty = empty && entry.path().filename().string().starts_with('.');
  });
  if (empty || !recorded_by_locd(folder)) return empty;
  const auto earlier = read_file(folder / "rig.yaml");
  return earlier ? *earlier == rig_yaml : earlier.error().kind == ErrorKind::no_input;
}

}  // namespace

RecordingFolder::RecordingFolder(fs::path path, const RecordingFacts& facts,
                                 const RecordingBudget& budget)
    : path_(std::move(path)),
      cameras_(facts.cameras),
      ending_(facts.codec == "jpeg" ? ".jpg" : ".pgm"),
      budget_(budget) {
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
  RecordingFolder folder(path, facts, budget);
  if (!may_record_in(path, facts.rig_yaml)) {
    return fail(
        ErrorKind::cant_create,
        "{}: can't record here: it is not empty, and no recording of locd's with this rig; name "
        "another folder",
        path.string());
  }
  if (auto written = folder.write_texts(facts); !written) {
    return tl::make_unexpected(written.error());
  }
  if (auto opened = folder.open_folders(); !opened) return tl::make_unexpected(opened.error());
  folder.list_earlier_sets(facts.sync_tolerance);
  if (!facts.archive.empty()) folder.earlier_ = RecordingArchive(facts.archive, path);
  return folder;
}

Status RecordingFolder::write_texts(const RecordingFacts& facts) {
  // By the first the folder is known as locd's own.
  const std::pair<const char*, const std::string> texts[] = {{"capture.toml", capture_toml(facts)},
                                                             {"rig.yaml", facts.rig_yaml},
                                                             {"markers.toml", facts.markers_toml}};
  for (const auto& [name, text] : texts) {
    if (text.empty()) continue;
    if (auto written = write_file_atomically(path_ / name, text); !written) return written;
  }
  return {};
}

Status RecordingFolder::open_folders() {
  for (const std::string& camera : cameras_) {
    const fs::path folder = path_ / camera;
    std::error_code ignored;  // opening it says what is wrong
    fs::create_directory(folder, ignored);
    folders_.emplace_back(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!folders_.back().valid()) {
      return fail(creation_error(), "{}: can't create: {}", folder.string(), system_reason());
    }
  }
  auto table = FrameTable::open(path_ / "frames.csv");
  if (!table) return tl::make_unexpected(table.error());
  table_.emplace(std::move(*table));
  return {};
}

void RecordingFolder::list_earlier_sets(Stamp tolerance) {
  std::map<Stamp, SetOnDisk> found;
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    // What can't be listed is not counted.
    walk_folder<fs::directory_iterator>(path_ / cameras_[c], [&](const fs::directory_entry& entry) {
      std::error_code gone;
      const auto t_ns = parse_whole<std::int64_t>(entry.path().stem().string());
      if (entry.path().extension() != ending_ || !t_ns) {
        // Left half-written by a process that was killed.
        if (entry.path().filename().string().ends_with(".part")) fs::remove(entry, gone);
        return;
      }
      const auto bytes = entry.file_size(gone);
      if (gone) return;
      const Stamp stamp(*t_ns);
      auto near = found.lower_bound(stamp - tolerance);
      if (near == found.end() || near->first > stamp + tolerance) {
        near = found.emplace(stamp, SetOnDisk{stamp, 0, {}}).first;
      }
      near->second.bytes += bytes;
      near->second.images.push_back({c, stamp});
    });
  }
  for (auto& [stamp, set] : found) {
    images_ += set.images.size();
    image_bytes_ += set.bytes;
    sets_.push_back(std::move(set));
  }
  unlisted_ = images_;  // for all that is known before the table is read
  (void)forget_deleted_rows();
}

std::string RecordingFolder::file_name(Stamp stamp) const {
  return fmt::format("{}{}", stamp.count(), ending_);
}

Status RecordingFolder::write_set(const std::vector<RecordedImage>& images) {
  const std::string rows = rows_of(images);
  SetOnDisk set;
  set.stamp = images.front().info.stamp;
  for (const RecordedImage& image : images) set.bytes += image.bytes.size();
  if (auto room = make_room(set.bytes + rows.size()); !room) return room;
  if (auto rewritten = forget_deleted_rows(); !rewritten) return rewritten;
  for (const RecordedImage& image : images) {
    if (auto written = write_image(image); !written) {
      delete_set(set);
      return written;
    }
    set.images.push_back({image.camera, image.info.stamp});
  }
  if (auto appended = table_->append(rows); !appended) {
    delete_set(set);
    return appended;
  }
  images_ += set.images.size();
  image_bytes_ += set.bytes;
  sets_.push_back(std::move(set));
  delete_outdated();
  return unsynced_.size() >= kMaxUnsynced ? sync() : Status{};
}

Expected<std::uint64_t> RecordingFolder::free_bytes() const {
  struct statvfs disk {};
  if (::statvfs(path_.c_str(), &disk) == 0) return std::uint64_t{disk.f_bavail} * disk.f_frsize;
  return fail(ErrorKind::io, "{}: can't ask for free space: {}", path_.string(), system_reason());
}

tl::unexpected<Error> RecordingFolder::no_room(std::uint64_t free_bytes) const {
  return fail(ErrorKind::io,
              "{}: {} bytes are free, {} must stay free; make room, or lower [record] "
              "min_free_bytes",
              path_.string(), free_bytes, budget_.min_free_bytes);
}

Status RecordingFolder::make_room(std::uint64_t bytes) {
  const std::uint64_t needed = budget_.min_free_bytes + bytes;
  auto free = free_bytes();
  if (!free) return tl::make_unexpected(free.error());
  // Somebody else has filled the disk: all that could be deleted would not make up for it.
  if (*free + image_bytes_ + earlier_.bytes() < needed) return no_room(*free);
  while (has_oldest() && earlier_.bytes() + this->bytes() + bytes > budget_.max_bytes) {
    delete_oldest();
  }
  while ((free = free_bytes()) && *free < needed) {
    if (!has_oldest()) return no_room(*free);
    delete_oldest();
  }
  return free ? Status{} : tl::make_unexpected(free.error());
}

void RecordingFolder::delete_outdated() {
  while (oldest() < sets_.back().stamp - budget_.keep) delete_oldest();
}

Status RecordingFolder::forget_deleted_rows() {
  if (table_->rows() + 2 * unlisted_ <= 2 * images_) return {};
  std::set<std::pair<std::string_view, Stamp>> kept;
  for (const SetOnDisk& set : sets_) {
    for (const ImageOnDisk& image : set.images) kept.emplace(cameras_[image.camera], image.stamp);
  }
  auto rewritten = table_->forget_all_but([&](std::string_view camera, Stamp stamp) {
    return kept.contains({camera, stamp});
  });
  if (rewritten) unlisted_ = images_ - std::min(images_, table_->rows());
  return rewritten;
}

void RecordingFolder::delete_oldest() {
  if (!earlier_.empty()) return earlier_.delete_oldest();
  const SetOnDisk oldest = std::move(sets_.front());
  sets_.pop_front();
  images_ -= oldest.images.size();
  image_bytes_ -= oldest.bytes;
  delete_set(oldest);
  // At once, for a kill may come between two; a full disk may take it only once there is room.
  (void)forget_deleted_rows();
}

void RecordingFolder::delete_set(const SetOnDisk& set) {
  for (const ImageOnDisk& image : set.images) {
    ::unlinkat(folders_[image.camera].get(), file_name(image.stamp).c_str(), 0);
  }
}

Status RecordingFolder::write_image(const RecordedImage& image) {
  const int folder = folders_[image.camera].get();
  const std::string name = file_name(image.info.stamp);
  const std::string hidden = "." + name + ".part";
  const auto failed = [&] {
    const std::string why = system_reason();
    ::unlinkat(folder, hidden.c_str(), 0);
    return fail(ErrorKind::io, "{}: can't write: {}",
                (path_ / cameras_[image.camera] / name).string(), why);
  };
  Descriptor file(::openat(folder, hidden.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!file.valid() || !write_all(file.get(), image.bytes)) return failed();
  // The kernel begins to write at once, so that the sync of a second's images is not one long stop.
  ::sync_file_range(file.get(), 0, 0, SYNC_FILE_RANGE_WRITE);
  if (::renameat(folder, hidden.c_str(), folder, name.c_str()) != 0) return failed();
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

Status RecordingFolder::sync() {
  bool good = true;
  for (const Descriptor& file : unsynced_) good = ::fdatasync(file.get()) == 0 && good;
  unsynced_.clear();
  for (const Descriptor& folder : folders_) good = ::fsync(folder.get()) == 0 && good;
  good = table_->sync() && good;
  if (good) return {};
  return fail(ErrorKind::io, "{}: can't bring images to the disk: {}", path_.string(),
              system_reason());
}

}  // namespace waymark
