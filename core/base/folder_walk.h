#pragma once

#include <filesystem>
#include <system_error>

namespace waymark {

/// Calls `visit` with the entries of a folder (`Iterator`: std::filesystem's, recursive or not), as
/// far as they can be listed. Disks fail: nothing is thrown, as a range-for over them would.
template <typename Iterator, typename Visit>
void walk_folder(const std::filesystem::path& folder, const Visit& visit) {
  std::error_code failed;
  for (Iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    visit(*entry);
  }
}

}  // namespace waymark
