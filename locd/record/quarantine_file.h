#pragma once

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/geometry/stamp.h"
#include "core/map/quarantine.h"

namespace waymark {

/// quarantine.json of the state folder, written in a thread of its own: a disk that stalls holds up
/// nobody else.
class QuarantineFile {
 public:
  explicit QuarantineFile(std::filesystem::path path) : path_(std::move(path)) {}
  /// Waits for what is not written yet.
  ~QuarantineFile();
  QuarantineFile(const QuarantineFile&) = delete;
  QuarantineFile& operator=(const QuarantineFile&) = delete;

  /// What is distrusted of that map, by the file or by what is yet to be written to it.
  [[nodiscard]] std::vector<QuarantinedMarker> of_map(const std::string& map_hash) const;

  /// Has it written, in place of what was not written yet.
  void write(Quarantine quarantine);
  /// Of the last write, when it failed; once.
  [[nodiscard]] std::optional<Error> take_failure();
  /// Waits until all is written or has failed; false when it is not at `deadline`.
  [[nodiscard]] bool settle(Stamp deadline) const;

 private:
  void run();

  const std::filesystem::path path_;
  mutable std::mutex mutex_;  ///< of everything below
  mutable std::condition_variable changed_;
  std::optional<Quarantine> newest_;  ///< not on the disk yet
  bool due_ = false;                  ///< newest_ is to be written
  bool writing_ = false;
  bool ending_ = false;
  std::optional<Error> failure_;
  std::thread thread_;
};

}  // namespace waymark
