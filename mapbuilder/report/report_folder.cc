#include "mapbuilder/report/report_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/base/output_check.h"
#include "mapbuilder/report/report_page.h"
#include "mapbuilder/report/summary_json.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

constexpr char kSummaryName[] = "summary.json";
constexpr char kPageName[] = "index.html";

/// Without a slash at the end, so that it has a name and a parent.
fs::path without_slash(const fs::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

fs::path parent_of(const fs::path& folder) {
  return folder.has_parent_path() ? folder.parent_path() : fs::path(".");
}

bool bears_mark(const fs::path& page) {
  std::string start(sizeof kPageMark - 1, '\0');
  std::ifstream file(page, std::ios::binary);
  return file.read(start.data(), static_cast<std::streamsize>(start.size())) && start == kPageMark;
}

/// Whether a folder may be replaced: empty, or an earlier report and nothing else.
bool is_replaceable(const fs::path& folder) {
  std::error_code error;
  std::size_t entries = 0;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if ((name != kSummaryName && name != kPageName) ||
        it->symlink_status(error).type() != fs::file_type::regular) {
      return false;
    }
    ++entries;
  }
  return !error && (entries == 0 || (entries == 2 && bears_mark(folder / kPageName)));
}

std::string reason() { return std::strerror(errno); }  // NOLINT(concurrency-mt-unsafe)

}  // namespace

Status check_report_folder(const fs::path& named) {
  const fs::path folder = without_slash(named);
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(folder, ignored);
  if (fs::exists(status) && !fs::is_directory(status)) {
    return fail(ErrorKind::cant_create,
                "{}: can't write a report: it is there already and is no folder; name another",
                folder.string());
  }
  if (fs::is_directory(status) && !is_replaceable(folder)) {
    return fail(ErrorKind::cant_create,
                "{}: can't write a report: the folder holds something else than an earlier report, "
                "which is left alone; name another",
                folder.string());
  }
  return check_place(folder);
}

ReportFolder::ReportFolder(fs::path folder, fs::path temporary)
    : folder_(std::move(folder)), temporary_(std::move(temporary)) {}

ReportFolder::ReportFolder(ReportFolder&& other) noexcept
    : folder_(std::move(other.folder_)), temporary_(std::exchange(other.temporary_, {})) {}

ReportFolder::~ReportFolder() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

Expected<ReportFolder> ReportFolder::write(const fs::path& named, const Report& report) {
  if (auto allowed = check_report_folder(named); !allowed) {
    return tl::make_unexpected(allowed.error());
  }
  const fs::path folder = without_slash(named);
  std::string temporary =
      (parent_of(folder) / ("." + folder.filename().string() + ".XXXXXX")).string();
  if (::mkdtemp(temporary.data()) == nullptr) {
    return fail(ErrorKind::cant_create, "{}: can't write a report: {}", folder.string(), reason());
  }
  ReportFolder result(folder, temporary);
  for (const auto& [name, content] : {std::pair{kSummaryName, format_summary(report)},
                                      std::pair{kPageName, format_report_page(report)}}) {
    if (auto written = write_file_atomically(result.temporary_ / name, content); !written) {
      return tl::make_unexpected(written.error());
    }
  }
  const mode_t mask = ::umask(0);
  ::umask(mask);
  ::chmod(temporary.c_str(), 0777 & ~mask);
  return result;
}

Status ReportFolder::put_in_place() {
  // Works where nothing is, and onto an empty folder.
  if (std::rename(temporary_.c_str(), folder_.c_str()) == 0) {
    temporary_.clear();
    return {};
  }
  // Looked at again: much time may have passed since the first look.
  if (auto allowed = check_report_folder(folder_); !allowed) return allowed;
  // Exchanged: at no moment there is neither the earlier report nor the new one.
  if (::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, folder_.c_str(), RENAME_EXCHANGE) != 0) {
    return fail(ErrorKind::cant_create, "{}: can't put the report there: {}; name another folder",
                folder_.string(), reason());
  }
  return {};  // the destructor removes the earlier one
}

}  // namespace waymark
