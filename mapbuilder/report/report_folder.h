#pragma once

#include <filesystem>

#include "core/base/error.h"
#include "mapbuilder/report/report.h"

namespace waymark {

/// Fails early when a report can't go to `folder`: something is there that is neither an empty
/// folder nor an earlier report (summary.json and a page that bears kPageMark, and nothing else),
/// or the folder it is to lie in is absent (cant_create) or not writable (permission).
[[nodiscard]] Status check_report_folder(const std::filesystem::path& folder);

/// A report on its way to disk: written whole beside its place, then put there in one step.
class ReportFolder {
 public:
  /// Writes summary.json and index.html to a temporary folder beside `folder`. Errors of
  /// check_report_folder and of write_file_atomically.
  [[nodiscard]] static Expected<ReportFolder> write(const std::filesystem::path& folder,
                                                    const Report& report);

  ReportFolder(ReportFolder&& other) noexcept;
  ReportFolder& operator=(ReportFolder&&) = delete;
  ~ReportFolder();  ///< removes what was not put in place

  /// Puts it in place of what check_report_folder allows. On failure (cant_create) the earlier
  /// report is as it was.
  [[nodiscard]] Status put_in_place();

 private:
  ReportFolder(std::filesystem::path folder, std::filesystem::path temporary);

  std::filesystem::path folder_;
  std::filesystem::path temporary_;  ///< empty once put in place
};

}  // namespace waymark
