#include "locd/record/recording_on_disk.h"

#include <algorithm>
#include <utility>

#include "locd/record/recording_files.h"

namespace waymark {
namespace {

bool has_line(const OwnFolder& capture, const std::string& beginning) {
  return ("\n" + capture.read(kCaptureToml)).find("\n" + beginning) != std::string::npos;
}

}  // namespace

bool recorded_by_locd(const OwnFolder& capture) { return has_line(capture, kRecordedByLocd); }

bool date_known(const OwnFolder& capture) { return has_line(capture, kDateKnown); }

RecordingOnDisk::RecordingOnDisk(OwnFolder archive, std::string name)
    : archive_(std::move(archive)), name_(std::move(name)) {}

std::optional<RecordingOnDisk> RecordingOnDisk::find(const OwnFolder& archive,
                                                     const std::string& name) {
  const auto folder = archive.folder(name);
  if (!folder || !recorded_by_locd(*folder)) return std::nullopt;
  RecordingOnDisk recording(archive, name);
  recording.dated_ = date_known(*folder);
  recording.opened_.emplace(list(*folder));
  return recording;
}

RecordingOnDisk RecordingOnDisk::earlier_part_of(const OwnFolder& recording, bool dated) {
  RecordingOnDisk part(recording, "");
  part.is_part_ = true;
  part.dated_ = dated;
  part.opened_.emplace(list(recording));
  return part;
}

RecordingOnDisk::Opened RecordingOnDisk::list(const OwnFolder& folder) {
  Opened opened{folder, {}, {}};
  folder.each_name([&](const std::string& name) {
    if (!is_camera_folder(name)) return;
    auto camera = folder.folder(name);
    if (!camera) return;  // a link, a mount: not of this recording
    camera->each_name([&](const std::string& file) {
      if (const auto stamp = stamp_of_image(file)) opened.images.push_back({*stamp, name, file});
    });
    opened.cameras.emplace(name, std::move(*camera));
  });
  std::sort(opened.images.begin(), opened.images.end(),
            [](const Image& a, const Image& b) { return a.stamp < b.stamp; });
  return opened;
}

bool RecordingOnDisk::reopen() {
  if (opened_) return true;
  const auto folder = archive_.folder(name_);
  if (folder) opened_.emplace(list(*folder));
  return opened_.has_value();
}

void RecordingOnDisk::weigh(Stamp tolerance, const std::atomic<bool>& enough) {
  tolerance_ = tolerance;
  images_ = opened_->images.size();
  Stamp set{0};
  for (const Image& image : opened_->images) {
    if (enough) return;
    count(opened_->cameras.at(image.camera).own_bytes(image.name));
    if (sets_ > 0 && image.stamp - set <= tolerance) continue;
    set = image.stamp;
    ++sets_;
  }
  if (images_ > 0) {
    oldest_ = opened_->images.front().stamp;
    newest_ = opened_->images.back().stamp;
  }
  if (is_part_ || kept_.files > 0) return;  // its texts stay with what stays
  for (const char* text : kRecordingTexts) count(opened_->folder.own_bytes(text));
}

void RecordingOnDisk::count(const Expected<std::uint64_t>& bytes) {
  if (bytes) {
    bytes_ += *bytes;
  } else if (bytes.error().kind != ErrorKind::no_input && kept_.files++ == 0) {
    kept_.first = bytes.error().message;
  }
}

std::string RecordingOnDisk::take_note() {
  if (kept_.files == 0 || std::exchange(told_, true)) return "";
  return fmt::format(
      "{}: {} of its files can't be deleted; they stay and do not count for [record] max_bytes: {}",
      (is_part_ ? archive_.path() : archive_.path() / name_).string(), kept_.files, kept_.first);
}

std::uint64_t RecordingOnDisk::delete_oldest_set() {
  if (!reopen()) {
    forget();
    return 0;
  }
  std::uint64_t made = 0;
  std::deque<Image>& images = opened_->images;
  const Stamp first = images.empty() ? Stamp{0} : images.front().stamp;
  while (!images.empty() && images.front().stamp - first <= tolerance_) {
    made += remove(opened_->cameras.at(images.front().camera), images.front().name);
    images.pop_front();
  }
  if (images.empty()) {
    if (!is_part_ && kept_.files == 0) made += remove_the_rest();
    forget();
    return made;
  }
  images_ = images.size();
  sets_ -= std::min<std::uint64_t>(sets_, 1);
  oldest_ = images.front().stamp;
  // Not 0 while images are left, though what is deleted may have grown since it was weighed.
  bytes_ = std::max<std::uint64_t>(1, bytes_ - std::min(bytes_, made));
  return made;
}

void RecordingOnDisk::forget() {
  bytes_ = images_ = sets_ = 0;
  opened_.reset();
}

std::uint64_t RecordingOnDisk::remove(const OwnFolder& folder, const std::string& file) {
  const auto removed = folder.remove(file);
  if (removed) return *removed;
  if (removed.error().kind != ErrorKind::no_input && kept_.files++ == 0) {
    kept_.first = removed.error().message;
  }
  return 0;
}

std::uint64_t RecordingOnDisk::remove_the_rest() {
  std::uint64_t made = 0;
  const auto remove_unfinished = [&](const OwnFolder& folder) {
    folder.each_name([&](const std::string& file) {
      if (is_unfinished(file)) made += remove(folder, file);
    });
  };
  for (const auto& [name, camera] : opened_->cameras) {
    remove_unfinished(camera);
    opened_->folder.remove_empty_folder(name);
  }
  remove_unfinished(opened_->folder);
  for (const char* text : kRecordingTexts) made += remove(opened_->folder, text);
  archive_.remove_empty_folder(name_);
  return made;
}

}  // namespace waymark
