#include "locd/record/frame_table.h"

#include <unistd.h>

#include <algorithm>
#include <string>

#include "core/base/atomic_file.h"
#include "core/base/system_call.h"
#include "core/base/text_field.h"
#include "locd/record/recording_files.h"

namespace waymark {

namespace {

constexpr std::string_view kHeader = "camera,t_ns,exposure_ns,sequence,stamp_quality\n";

std::uint64_t lines_of(std::string_view text) {
  return static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n'));
}

/// Whether the row is of a kept image; its first fields are the camera and the stamp.
bool is_kept(std::string_view row, const FrameTable::Kept& kept) {
  const auto camera = row.find(',');
  if (camera == std::string_view::npos) return false;
  const auto stamp = row.find(',', camera + 1);
  if (stamp == std::string_view::npos) return false;
  const auto t_ns = parse_whole<std::int64_t>(row.substr(camera + 1, stamp - camera - 1));
  return t_ns && kept(row.substr(0, camera), Stamp(*t_ns));
}

}  // namespace

FrameTable::FrameTable(OwnFolder recording)
    : recording_(std::move(recording)), path_(recording_.path() / kFrameTable) {}

Expected<FrameTable> FrameTable::open(const OwnFolder& recording) {
  FrameTable table(recording);
  if (auto opened = table.open_file(); !opened) return tl::make_unexpected(opened.error());
  if (auto known = table.take_stock(); !known) return tl::make_unexpected(known.error());
  return table;
}

Status FrameTable::open_file() {
  auto opened = recording_.open_to_append(kFrameTable);
  if (!opened) return tl::make_unexpected(opened.error());
  file_ = std::move(*opened);
  return {};
}

Status FrameTable::take_stock() {
  const auto text = read_file(path_);
  if (!text) return tl::make_unexpected(text.error());
  const auto last = text->rfind('\n');
  bytes_ = last == std::string::npos ? 0 : last + 1;
  if (bytes_ < text->size() && ::ftruncate(file_.get(), static_cast<off_t>(bytes_)) != 0) {
    return fail(ErrorKind::io, "{}: can't write: {}", path_.string(), system_reason());
  }
  if (bytes_ == 0) {
    auto begun = append(kHeader);
    rows_ = 0;
    return begun;
  }
  rows_ = lines_of(*text) - 1;
  return {};
}

Status FrameTable::append(std::string_view rows) {
  if (!write_all(file_.get(), rows)) {
    const std::string why = system_reason();
    // A part of them may have found room.
    const bool taken_back = ::ftruncate(file_.get(), static_cast<off_t>(bytes_)) == 0;
    return fail(ErrorKind::io, "{}: can't write: {}{}", path_.string(), why,
                taken_back ? "" : "; its last row is not whole");
  }
  bytes_ += rows.size();
  rows_ += lines_of(rows);
  return {};
}

Status FrameTable::forget_all_but(const Kept& kept) {
  const auto text = read_file(path_);
  if (!text) return tl::make_unexpected(text.error());
  std::string remaining(kHeader);
  for (std::size_t begin = std::min(text->find('\n'), text->size() - 1) + 1, end = 0;
       (end = text->find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::string_view row = std::string_view(*text).substr(begin, end + 1 - begin);
    if (is_kept(row, kept)) remaining += row;
  }
  if (auto ours = recording_.check_writable(kFrameTable); !ours) return ours;
  if (auto written = write_file_atomically(path_, remaining); !written) return written;
  if (auto opened = open_file(); !opened) return opened;
  bytes_ = remaining.size();
  rows_ = lines_of(remaining) - 1;
  return {};
}

bool FrameTable::sync() { return ::fdatasync(file_.get()) == 0; }

}  // namespace waymark
