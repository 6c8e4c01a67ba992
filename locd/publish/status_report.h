#pragma once

#include <optional>
#include <string>
#include <vector>
#include <waymark/status_t.hpp>

#include "locd/alert.h"
#include "locd/frames/rig_capture.h"
#include "locd/publish/localization_counts.h"

namespace waymark {

/// Which cameras came and went since the last look, and what a status message says of all of them.
/// Pure but for its memory of the last second.
class StatusReport {
 public:
  explicit StatusReport(const Rig& rig);

  /// Finds which cameras run: those that delivered within a second, or within three of their own
  /// periods.
  void judge(const std::vector<RigCapture::CameraState>& states, Stamp now);
  [[nodiscard]] bool all_run() const;

  /// Raised or over: a camera whose stamps can't be believed; one whose settings another program
  /// changes; one that delivers nothing for a second. A camera that never delivered is missing from
  /// `grace` after the first look on.
  [[nodiscard]] std::vector<Alert> camera_alerts(const std::vector<RigCapture::CameraState>& states,
                                                 Stamp now, Stamp grace);

  /// Something to be logged: the same of the same camera comes again under the same key.
  struct CameraNews {
    std::string key;   ///< "cam0 runs", "cam0 fails"
    std::string text;  ///< "cam0: GREY 1224×1024 at 30/s, …"
  };
  /// One per camera that runs in another way than before, or that fails for another reason.
  [[nodiscard]] std::vector<CameraNews> camera_news(
      const std::vector<RigCapture::CameraState>& states);

  /// The first camera that only another configuration can mend; nullopt: none.
  [[nodiscard]] std::optional<Error> misconfiguration(
      const std::vector<RigCapture::CameraState>& states) const;

  /// Fills cameras, rates, drops and counts; `interval` since the last call.
  void fill(const std::vector<RigCapture::CameraState>& states, const LocalizationCounts& counts,
            Stamp interval, status_t& status);

  /// One line: "OK 97 % of 30/s, 14 markers, 3 mm; cam1 missing: no such device". `poses`: how they
  /// are, as Telemetry sums them up.
  [[nodiscard]] static std::string text(const status_t& status, const std::string& poses);

 private:
  struct Memory {
    std::string name;
    std::string description;
    std::string error;
    std::string changed_settings;
    bool running = false;
    bool missing = false;
    bool unsynced = false;
    bool settings = false;  ///< changed by another program
    std::uint64_t frames_judged = 0;
    Stamp last_frame{0};
    Stamp period = std::chrono::seconds(1);  ///< between frames; until two came, a slow guess
    std::uint64_t frames_filled = 0;         ///< when rates were computed last
  };
  std::vector<Memory> cameras_;
  std::uint64_t last_sets_ = 0;
  std::optional<Stamp> first_look_;
};

}  // namespace waymark
