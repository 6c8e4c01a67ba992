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
#include "locd/frames/back_off.h"

namespace waymark {

/// quarantine.json of the state folder. It is written in a thread of its own, so that a slow disk
/// delays no other thread; a write that fails is repeated until it succeeds. A file that can't be
/// used is set aside, never overwritten.
class QuarantineFile {
 public:
  explicit QuarantineFile(std::filesystem::path path) : path_(std::move(path)) {}
  /// Tries once more to write what is not written yet, and waits for that.
  ~QuarantineFile();
  QuarantineFile(const QuarantineFile&) = delete;
  QuarantineFile& operator=(const QuarantineFile&) = delete;

  /// The quarantined markers of that map, those not written to the file yet included. A file that
  /// is damaged, unreadable or of a newer locd is renamed to quarantine.json.damaged.
  [[nodiscard]] std::vector<QuarantinedMarker> of_map(const std::string& map_hash);

  /// All that it holds, of whatever map, what is not written yet included; empty: nothing. A file
  /// that can't be used is renamed likewise.
  [[nodiscard]] Quarantine known();

  /// Has it written, in place of what was not written yet.
  void write(Quarantine quarantine);

  /// What is wrong with it, for as long as it is; empty: nothing.
  [[nodiscard]] std::string trouble() const;
  struct News {
    std::string text;
    bool wrong = false;
  };
  /// What went wrong with it, or is well again, since the last call.
  [[nodiscard]] std::vector<News> take_news();

  /// Tries at once, where it waits to try again. Returns when all is written or has failed; false
  /// when neither is so at `deadline`.
  [[nodiscard]] bool settle(Stamp deadline);

 private:
  void run();
  /// Waits until something is to be written now; false: nothing will be.
  [[nodiscard]] bool wait_for_work(std::unique_lock<std::mutex>& lock);
  [[nodiscard]] Status replace_by(const Quarantine& quarantine);
  /// The file's content; nullopt: none, or none that can be used, which is then set aside. Errors:
  /// those of setting it aside.
  [[nodiscard]] Expected<std::optional<Quarantine>> read_or_set_aside();
  [[nodiscard]] Status set_aside(const Error& why);
  void tell_failure(const Status& written);

  const std::filesystem::path path_;
  std::mutex disk_;           ///< of the file; held while the disk works
  mutable std::mutex mutex_;  ///< of everything below
  mutable std::condition_variable changed_;
  std::optional<Quarantine> newest_;  ///< not on the disk yet
  bool due_ = false;                  ///< newest_ is to be written
  bool writing_ = false;
  bool hurry_ = false;  ///< the next attempt does not wait for its time
  bool ending_ = false;
  BackOff pauses_;
  Stamp next_attempt_{0};
  std::string damage_;   ///< what was set aside, until the program ends
  std::string failure_;  ///< of the last attempt to write
  std::vector<News> news_;
  std::thread thread_;
};

}  // namespace waymark
