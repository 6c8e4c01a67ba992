#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <ostream>

#include "core/base/error.h"

namespace waymark {

/// locd --replay
struct ReplayCommandOptions {
  std::filesystem::path capture;
  std::filesystem::path map;
  std::optional<std::filesystem::path> trajectory;  ///< TUM, poses that are OK or DEGRADED
  bool loop = false;                                ///< until stopped
  bool realtime = false;                            ///< at the capture's own pace
  bool redetect = false;  ///< look at the images though detections.csv lies beside them
  std::optional<std::filesystem::path> table;  ///< CSV: a line per set, all that its pose says
};

/// Localizes a capture's frame sets against a map as the daemon would, without LCM. Without
/// `realtime` every set is solved and the output is the same, byte for byte, each time. A summary
/// goes to `out`, alerts and notes to `notes`. The trajectory's stamps are the sets' own (that of
/// the lowest-numbered camera), its poses moved there by the velocity where it is known. `stop`
/// ends it early, with what there is so far written.
/// Errors: those of the capture, the map and the output; bad_data when the rig has too many
/// cameras; usage when an output would replace what is read, or both are one file.
[[nodiscard]] Status run_replay(const ReplayCommandOptions& options, const std::atomic<bool>& stop,
                                std::ostream& out, std::ostream& notes);

}  // namespace waymark
