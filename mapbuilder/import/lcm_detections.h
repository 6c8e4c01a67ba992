#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/capture/detection.h"
#include "core/capture/frame_set.h"

namespace waymark {

/// What a log of locd's WAYMARK_DETECTIONS tells: a capture without images.
struct LoggedDetections {
  std::string channel;
  std::string session;          ///< of its first message
  std::string rig_fingerprint;  ///< that locd had; 16 hexadecimal digits, or empty: nobody said it
  std::size_t cameras = 0;      ///< of the rig
  std::size_t frame_sets = 0;
  std::vector<ImageDetections> images;  ///< by rising (stamp, camera)
  /// Keeps together what locd had in one set.
  Stamp sync_tolerance = kDefaultSyncTolerance;
};

/// A frame set as one message tells it.
struct LoggedSet {
  std::int64_t sequence = 0;
  std::string session;
  std::string rig_fingerprint;
  std::vector<ImageDetections> images;  ///< one per camera that gave a frame, by rising camera
  std::size_t cameras = 0;
};

/// Whether the bytes are a waymark.detections_t of this version, by the hash in front.
[[nodiscard]] bool is_detections_message(std::span<const std::uint8_t> message);

/// Takes one waymark.detections_t apart. An own decoder, for LCM's makes room for as many markers
/// as a message states before it looks whether they are there. bad_data, without a file's name, for
/// counts that the bytes do not hold, unknown families, ids outside their family, cameras that gave
/// no frame, corners that are no pixels and covariances that are none.
[[nodiscard]] Expected<LoggedSet> decode_detections(std::span<const std::uint8_t> message);

/// Reads the detections in a log of lcm-logger, other channels passed over. `channel`: which, where
/// several hold detections; empty: the only one. Errors: those of LcmLog and decode_detections;
/// bad_data for a log without such messages, with those of another version, of several channels
/// where none was chosen, of several rigs, or with a set of a stamp that was there.
[[nodiscard]] Expected<LoggedDetections> read_lcm_detections(const std::filesystem::path& log,
                                                             const std::string& channel,
                                                             Progress& progress);

}  // namespace waymark
